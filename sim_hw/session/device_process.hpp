#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <span>

namespace greenloop {

/// A child process that is the device: it talks to the loop through multicast only, and leaves its summary in a pipe.
class DeviceProcess {
 public:
  /// Forks. The child waits for start(), runs `life` and exits; what it then has in `summary` is there in the parent,
  /// too, once it has ended. No other thread may run. Throws std::runtime_error if the system refuses.
  DeviceProcess(const std::function<void()>& life, std::span<std::byte> summary);
  /// Ends the child if it still runs.
  ~DeviceProcess();
  DeviceProcess(const DeviceProcess&) = delete;
  DeviceProcess& operator=(const DeviceProcess&) = delete;

  /// To be called when the loop listens.
  void start();

  /// Whether the child has exited. Throws std::runtime_error if it failed.
  [[nodiscard]] bool ended();

 private:
  void read_summary(int exit_status);

  pid_t child_ = -1;
  int start_pipe_[2] = {-1, -1};
  int summary_pipe_[2] = {-1, -1};
  std::span<std::byte> summary_;
};

}  // namespace greenloop
