#pragma once

#include <atomic>
#include <cstdint>
#include <semaphore>
#include <thread>

#include "runtime/hosted/thread_clock.hpp"
#include "runtime/newest.hpp"
#include "sim_hw/guard/allocation_guard.hpp"

namespace greenloop {

/// Runs the loop proper on a thread of its own, away from everything that sends, waits or allocates. States and
/// commands pass through wait-free hand-overs; the semaphores beside them only let a thread sleep in virtual time.
/// Loop: a ControlLoop or MotionLoop, whose cycle() and answer() may not allocate; Log: adds what they did.
template <class Loop, class Log>
class LoopThread {
 public:
  using State = typename Loop::State;
  using Command = typename Loop::Command;

  LoopThread(Loop& loop, Log& log) : loop_(&loop), log_(&log), thread_([this] { run(); }) {}
  ~LoopThread() {
    stop_ = true;
    state_waits_.release();
    thread_.join();
  }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Hands over `state` and sleeps until its answer is there. Not loop-safe.
  [[nodiscard]] const Command& answer(const State& state) {
    states_.put(state);
    state_waits_.release();
    command_waits_.acquire();
    (void)commands_.take(newest_answer_);
    return newest_answer_;
  }

  /// Heap allocations and releases seen while a cycle ran.
  [[nodiscard]] std::uint64_t allocations() const { return allocations_.load(); }

 private:
  void run() {
    for (state_waits_.acquire(); !stop_; state_waits_.acquire()) {
      run_cycle();
      command_waits_.release();
    }
  }

  void run_cycle() {
    if (!states_.take(state_)) return;
    const std::int64_t begin = thread_nanoseconds();
    allocation_guard::arm();
    loop_->cycle(state_);
    allocation_guard::disarm();
    const std::int64_t end = thread_nanoseconds();
    allocation_guard::arm();
    loop_->answer(command_);
    commands_.put(command_);
    allocation_guard::disarm();
    allocations_ = allocation_guard::count();
    if constexpr (requires(Loop & loop) { loop.refer(); }) loop_->refer();
    log_->add(*loop_, state_.cycle, static_cast<double>(end - begin) / 1000);
  }

  Loop* loop_;
  Log* log_;
  Newest<State> states_;
  Newest<Command> commands_;
  State state_{};            ///< the loop thread's
  Command command_{};        ///< the loop thread's
  Command newest_answer_{};  ///< the caller's
  std::binary_semaphore state_waits_{0}, command_waits_{0};
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> allocations_{0};
  std::thread thread_;
};

}  // namespace greenloop
