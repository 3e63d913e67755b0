#include "sim_hw/control_loop/loop_thread.hpp"

#include "runtime/hosted/thread_clock.hpp"
#include "sim_hw/guard/allocation_guard.hpp"

namespace greenloop {

LoopThread::LoopThread(ControlLoop& loop, RunLog& log) : loop_(&loop), log_(&log), thread_([this] { run(); }) {}

LoopThread::~LoopThread() {
  stop_ = true;
  state_waits_.release();
  thread_.join();
}

const LoopCommand& LoopThread::answer(const DeviceState& state) {
  states_.put(state);
  state_waits_.release();
  command_waits_.acquire();
  (void)commands_.take(newest_answer_);
  return newest_answer_;
}

void LoopThread::run() {
  for (state_waits_.acquire(); !stop_; state_waits_.acquire()) {
    run_cycle();
    command_waits_.release();
  }
}

void LoopThread::run_cycle() {
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
  loop_->refer();
  log_->add(*loop_, state_.cycle, static_cast<double>(end - begin) / 1000);
}

}  // namespace greenloop
