#include "sim_hw/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "runtime/contact_body.hpp"
#include "sim_hw/control_loop/loop_thread.hpp"
#include "sim_hw/session/device_process.hpp"
#include "sim_hw/session/hosted_contact_body.hpp"
#include "sim_hw/session/interruption.hpp"
#include "sim_hw/session/loaded_model.hpp"
#include "sim_hw/transport/channel.hpp"
#include "sim_hw/transport/lock_step.hpp"
#include "sim_hw/transport/network_namespace.hpp"

namespace greenloop {
namespace {

/// Units; 0: none is asked for.
std::uint64_t budget_of(const SessionOptions& options, const Model& model) {
  const Elastostatic::Intent intent = Elastostatic::intended(model);
  const std::uint64_t whole = options.budget != 0 ? options.budget : intent.budget.work;
  return static_cast<std::uint64_t>(std::floor(static_cast<double>(whole) * options.starve));
}

/// Room for the contacts of the scene, and, if there is budget for them, for more: what lies under a tool without being
/// pushed takes some, too.
ContactBody::Limits limits_of(const Model& model, std::uint32_t contacts) {
  ContactBody::Limits limits;
  limits.elastostatic = Elastostatic::intended(model).limits;
  limits.elastostatic.max_contacts = contacts;
  limits.elastostatic.iterations = 64;
  limits.elastostatic.model_loads = true;
  limits.max_tools = max_tools;
  limits.max_points = 1;  // of a ball
  return limits;
}

struct Agreement {
  ContactBody::Limits limits;
  Budget budget;
  std::uint64_t least_work = 0;
};

Agreement agree(const SessionOptions& options, const Model& model) {
  constexpr std::uint32_t usual = 64;
  const std::uint32_t intended = std::min(Elastostatic::intended(model).limits.max_contacts, LoopCommand::max_contacts);
  Agreement agreement;
  for (std::uint32_t contacts = std::max(intended, usual);; contacts = std::max(contacts / 2, intended)) {
    agreement.limits = limits_of(model, contacts);
    const auto need = ContactBody::required(model, agreement.limits);
    agreement.least_work = need.least_work;
    const std::uint64_t asked = budget_of(options, model);
    agreement.budget.work =
        asked != 0 ? asked
                   : static_cast<std::uint64_t>(std::floor(static_cast<double>(need.worst_work) * options.starve));
    if (agreement.budget.work >= need.least_work) return agreement;
    if (contacts == intended) break;
  }
  throw std::runtime_error("budget: " + std::to_string(agreement.budget.work) +
                           " units per cycle cannot hold even the coarsest answer; the least budget of this model is " +
                           std::to_string(agreement.least_work));
}

double rate_of(const SessionOptions& options, const Elastostatic::Intent& intent) {
  const double rate = options.rate.value_or(intent.rate);
  if (rate < least_rate || rate > most_rate) {
    throw std::runtime_error(options.model.string() + ": rate: " + std::to_string(intent.rate) +
                             " Hz is outside the 100 to 100000 Hz of the simulated hand; give another with --rate");
  }
  return rate;
}

/// m/s^2: to where nothing can be touched, along the nearest axis, for there the body stands.
Double3 gravity_of(const BodySurface& surface) {
  constexpr double earth = 9.81;
  Double3 held;
  for (std::size_t i = 0; i < surface.position.size(); ++i) {
    if (!surface.touchable[i]) held += surface.position[i] - surface.centre;
  }
  const double x = std::abs(held.x), y = std::abs(held.y), z = std::abs(held.z);
  if (z >= x && z >= y) return {0, 0, held.z > 0 ? earth : -earth};
  return y >= x ? Double3{0, held.y > 0 ? earth : -earth, 0} : Double3{held.x > 0 ? earth : -earth, 0, 0};
}

DeviceSetup device_setup(const SessionOptions& options, double rate, const BodySurface& surface,
                         const layout::Info& info) {
  constexpr double round_seconds = 10;
  const double rounds = std::max(1.0, std::floor(options.seconds / round_seconds + 0.5));
  const ProbeSize probe = probe_size(surface);
  DeviceSetup setup;
  const Double3 down = gravity_of(surface);
  setup.gravity = {down, options.script == Script::tilt ? norm(down) * perpendicular(unit(down)) : down,
                   options.seconds / rounds};
  setup.motion = make_script(options.script, surface, probe, options.seconds / rounds, options.tools);
  setup.coupling = coupling(info, surface, probe, setup.hand);
  setup.origin = surface.centre;
  setup.period = 1 / rate;
  setup.cycles = std::llround(options.seconds * rate);
  setup.faults = options.faults;
  if (options.script == Script::lose_messages && setup.faults.loss_every == 0) setup.faults.loss_every = 10;
  return setup;
}

/// Decides before the run; `transport_reason` says why it is not two processes.
void choose_transport(const SessionOptions& options, SessionResult& result) {
  result.transport = "memq";
  result.processes = 1;
  if (options.transport == Transport::memq) {
    result.transport_reason = "asked for";
    return;
  }
  const NamespaceEntry entry = enter_loopback_namespace();
  if (entry.entered) {
    result.transport = "udpm";
    result.processes = 2;
  } else if (options.transport == Transport::udpm) {
    throw std::runtime_error("--transport udpm: " + entry.reason + "; use auto or memq");
  } else {
    result.transport_reason = entry.reason;
  }
}

/// Answers through `channel` what `loop` says, and notes the digest of what was said last.
LoopEnd loop_end(Channel& channel, LoopThread& loop, SessionResult& result) {
  const auto answer = [&loop](const DeviceState& state) -> const LoopCommand& { return loop.answer(state); };
  const auto send = [&channel, &result](const LoopCommand& command) {
    result.loop_digest = command.digest;
    channel.send(command);
  };
  return {answer, send};
}

/// Both ends in one process, each driven by the messages of the other.
void run_in_memory(HapticDevice& device, LoopThread& loop, SessionResult& result) {
  Channel channel(Channel::memory);
  DeviceEnd device_end(device, [&](const DeviceState& state) { channel.send(state); });
  LoopEnd end = loop_end(channel, loop, result);
  channel.on_state([&](const DeviceState& state) { end.receive(state); });
  channel.on_command([&](const LoopCommand& command) { device_end.receive(command); });
  device_end.start();
  while (!device.finished() && interruption() == 0) {
    if (!channel.receive(DeviceEnd::patience_ms)) device_end.silence();
  }
}

/// The loop's end here, the device in a process of its own.
void run_loop_process(DeviceProcess& device, LoopThread& loop, SessionResult& result) {
  Channel channel(Channel::multicast);
  LoopEnd end = loop_end(channel, loop, result);
  channel.on_state([&](const DeviceState& state) { end.receive(state); });
  device.start();
  while (!device.ended()) {
    while (interruption() == 0 && channel.receive(20)) {
    }
    if (interruption() != 0) return;
  }
  result.device = device.summary();
}

}  // namespace

SessionResult run_session(const SessionOptions& options) {
  const LoadedModel loaded = load_model(options.model);
  const Model& model = loaded.model;
  const Agreement agreement = agree(options, model);
  const bool gravity = model.view().has_gravity();
  if (options.script == Script::tilt && !gravity) {
    throw std::runtime_error(options.model.string() + ": --script tilt: the model knows no gravity; build it from a " +
                             "scene with gravity = true");
  }
  SessionResult result;
  const Elastostatic::Intent intent = Elastostatic::intended(model);
  result.rate = rate_of(options, intent);
  result.share = options.share.value_or(intent.share);
  result.least_work = agreement.least_work;
  result.budget = agreement.budget;
  const BodySurface surface = body_surface(model);
  HapticDevice device(device_setup(options, result.rate, surface, *model.view().info));
  result.tools = device.state().num_tools;
  result.cycles_asked = std::llround(options.seconds * result.rate);
  result.log = RunLog(static_cast<std::size_t>(result.cycles_asked), model.node_count());

  HostedContactBody body(model, agreement.limits);
  ControlLoop loop(body.body(), {.probe_radius = probe_size(surface).radius,
                                 .friction = options.friction,
                                 .gravity = gravity,
                                 .budget = result.budget,
                                 .field_every = options.field_every,
                                 .overrun_cycle = options.overrun_cycle});
  choose_transport(options, result);
  // the child must be born before there are threads
  std::optional<DeviceProcess> child;
  if (result.processes == 2) child.emplace(device);
  LoopThread thread(loop, result.log);
  if (child) {
    run_loop_process(*child, thread, result);
  } else {
    run_in_memory(device, thread, result);
    result.device = device.summary();
  }
  result.allocations = thread.allocations();
  result.interruption = interruption();
  return result;
}

}  // namespace greenloop
