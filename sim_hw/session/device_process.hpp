#pragma once

#include <sys/types.h>

#include "sim_hw/device/haptic_device.hpp"

namespace greenloop {

/// A child process that is the device: it talks to the loop through multicast only, and leaves its summary in a pipe.
class DeviceProcess {
 public:
  /// Forks. The child waits for start(), runs `device` to its end and exits. No other thread may run.
  /// Throws std::runtime_error if the system refuses.
  explicit DeviceProcess(HapticDevice& device);
  /// Ends the child if it still runs.
  ~DeviceProcess();
  DeviceProcess(const DeviceProcess&) = delete;
  DeviceProcess& operator=(const DeviceProcess&) = delete;

  /// To be called when the loop listens.
  void start();

  /// Whether the child has exited. Throws std::runtime_error if it failed.
  [[nodiscard]] bool ended();

  /// What the child counted; valid once it has ended.
  [[nodiscard]] const DeviceSummary& summary() const { return summary_; }

 private:
  void read_summary(int exit_status);

  pid_t child_ = -1;
  int start_pipe_[2] = {-1, -1};
  int summary_pipe_[2] = {-1, -1};
  DeviceSummary summary_;
};

}  // namespace greenloop
