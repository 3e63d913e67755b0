#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "runtime/loop.hpp"
#include "sim_hw/control_loop/loop_thread.hpp"
#include "sim_hw/session/device_process.hpp"
#include "sim_hw/session/interruption.hpp"
#include "sim_hw/transport/channel.hpp"
#include "sim_hw/transport/lock_step.hpp"

namespace greenloop {

enum class Transport { automatic, udpm, memq };

/// What was asked of device and loop, how they talked to each other, and how that ended.
struct LinkResult {
  double rate = 0;   ///< Hz
  double share = 1;  ///< of a period
  std::int64_t cycles_asked = 0;
  Budget budget;
  std::uint64_t least_work = 0;  ///< units, the least budget
  std::string transport;         ///< "udpm" or "memq"
  std::string transport_reason;  ///< why not two processes; empty for udpm
  int processes = 0;
  std::int64_t loop_digest = 0;  ///< of the last command sent
  std::uint64_t allocations = 0;
  int interruption = 0;  ///< the signal that ended the run early, 0: none
};

/// Decides before the run; `transport_reason` says why it is not two processes. With udpm the calling thread changes to
/// a network namespace of its own; no other thread may run then. Throws std::runtime_error if udpm is asked for and
/// refused.
void choose_transport(Transport transport, LinkResult& result);

namespace link {

/// Answers through `channel` what `loop` says, and notes the digest of what was said last.
template <class Loop, class Log>
LoopEnd<typename Loop::State, typename Loop::Command> loop_end(Channel& channel, LoopThread<Loop, Log>& loop,
                                                               LinkResult& result) {
  using State = typename Loop::State;
  using Command = typename Loop::Command;
  const auto answer = [&loop](const State& state) -> const Command& { return loop.answer(state); };
  const auto send = [&channel, &result](const Command& command) {
    result.loop_digest = command.digest;
    channel.send(command);
  };
  return {answer, send};
}

/// Both ends in one process, each driven by the messages of the other.
template <class Device, class Loop, class Log>
void run_in_memory(Device& device, LoopThread<Loop, Log>& loop, LinkResult& result) {
  Channel channel(Channel::memory);
  DeviceEnd<Device> device_end(device, [&](const typename Loop::State& state) { channel.send(state); });
  auto end = loop_end(channel, loop, result);
  channel.on_state([&](const typename Loop::State& state) { end.receive(state); });
  channel.on_command([&](const typename Loop::Command& command) { device_end.receive(command); });
  device_end.start();
  while (!device.finished() && interruption() == 0) {
    if (!channel.receive(patience_ms)) device_end.silence();
  }
}

/// The device's end, in a process of its own.
template <class Device>
void run_device(Device& device) {
  Channel channel(Channel::multicast);
  DeviceEnd<Device> end(device, [&](const typename Device::State& state) { channel.send(state); });
  channel.on_command([&](const typename Device::Command& command) { end.receive(command); });
  end.start();
  while (!device.finished()) {
    if (!channel.receive(patience_ms)) end.silence();
  }
}

/// The loop's end here, the device in a process of its own.
template <class Loop, class Log>
void run_loop_process(DeviceProcess& device, LoopThread<Loop, Log>& loop, LinkResult& result) {
  Channel channel(Channel::multicast);
  auto end = loop_end(channel, loop, result);
  channel.on_state([&](const typename Loop::State& state) { end.receive(state); });
  device.start();
  while (!device.ended()) {
    while (interruption() == 0 && channel.receive(20)) {
    }
    if (interruption() != 0) return;
  }
}

}  // namespace link

/// Runs device and loop against each other in lock step, by the transport that `result` names; the device's summary is
/// there at the end. Throws std::runtime_error if one side vanishes.
template <class Device, class Loop, class Log>
void run_link(Device& device, Loop& loop, Log& log, LinkResult& result) {
  // the child must be born before there are threads
  std::optional<DeviceProcess> child;
  if (result.processes == 2) {
    child.emplace([&device] { link::run_device(device); }, std::as_writable_bytes(std::span(&device.summary(), 1)));
  }
  LoopThread<Loop, Log> thread(loop, log);
  if (child) {
    link::run_loop_process(*child, thread, result);
  } else {
    link::run_in_memory(device, thread, result);
  }
  result.allocations = thread.allocations();
  result.interruption = interruption();
}

}  // namespace greenloop
