#pragma once

#include <atomic>
#include <cstdint>
#include <semaphore>
#include <thread>

#include "runtime/newest.hpp"
#include "sim_hw/control_loop/control_loop.hpp"
#include "sim_hw/control_loop/run_log.hpp"

namespace greenloop {

/// Runs the loop proper on a thread of its own, away from everything that sends, waits or allocates. States and
/// commands pass through wait-free hand-overs; the semaphores beside them only let a thread sleep in virtual time.
class LoopThread {
 public:
  LoopThread(ControlLoop& loop, RunLog& log);
  ~LoopThread();
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Hands over `state` and sleeps until its answer is there. Not loop-safe.
  [[nodiscard]] const LoopCommand& answer(const DeviceState& state);

  /// Heap allocations and releases seen while a cycle ran.
  [[nodiscard]] std::uint64_t allocations() const { return allocations_.load(); }

 private:
  void run();
  void run_cycle();

  ControlLoop* loop_;
  RunLog* log_;
  Newest<DeviceState> states_;
  Newest<LoopCommand> commands_;
  DeviceState state_{};          ///< the loop thread's
  LoopCommand command_{};        ///< the loop thread's
  LoopCommand newest_answer_{};  ///< the caller's
  std::binary_semaphore state_waits_{0}, command_waits_{0};
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> allocations_{0};
  std::thread thread_;
};

}  // namespace greenloop
