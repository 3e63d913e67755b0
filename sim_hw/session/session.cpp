#include "sim_hw/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "runtime/contact_body.hpp"
#include "sim_hw/session/agreement.hpp"
#include "sim_hw/session/hosted_contact_body.hpp"
#include "sim_hw/session/loaded_model.hpp"
#include "sim_hw/session/motions.hpp"

namespace greenloop {
namespace {

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

/// Cycles of the device for each step of the body.
std::int64_t steps_between(const SessionOptions& options, double rate) {
  const double ratio = options.fast_rate.value_or(rate) / rate;
  const auto whole = static_cast<std::int64_t>(std::llround(ratio));
  if (whole < 1 || std::abs(ratio - static_cast<double>(whole)) > 1e-9) {
    throw std::runtime_error("--fast-rate: " + std::to_string(*options.fast_rate) + " Hz is no multiple of the " +
                             std::to_string(rate) + " Hz of the loop");
  }
  return whole;
}

/// rate: of the device.
DeviceSetup device_setup(const SessionOptions& options, double rate, const BodySurface& surface,
                         const layout::Info& info) {
  constexpr double round_seconds = 10;
  const bool random = options.script == Script::random;
  const double rounds = random ? 1 : std::max(1.0, std::floor(options.seconds / round_seconds + 0.5));
  const ProbeSize probe = probe_size(surface);
  DeviceSetup setup;
  const Double3 down = gravity_of(surface);
  setup.gravity = {down, options.script == Script::tilt ? norm(down) * perpendicular(unit(down)) : down,
                   options.seconds / rounds};
  setup.motion = make_script(options.script, surface, probe, options.seconds / rounds, options.tools);
  setup.coupling = coupling(info, surface, probe, setup.hand);
  setup.coupling.force_scale *= options.gain;
  setup.hand = hand_of(options.hand);
  setup.delay = options.delay;
  setup.tank = {.enabled = options.passive == Passive::tank,
                .period = 1 / rate,
                .most_damping = 0.5 * hand_of(Holder::absent).mass * rate};
  setup.origin = surface.centre;
  setup.period = 1 / rate;
  setup.cycles = std::llround(options.seconds * rate);
  setup.faults = options.faults;
  const std::int64_t lost = options.script == Script::lose_messages ? 10 : random ? 97 : 0;
  if (setup.faults.loss_every == 0) setup.faults.loss_every = lost;
  return setup;
}

/// m/N of the body, of the softest virtual coupling that any body needs: at the handle as stiff as the loop may be.
double coupling_compliance(const SessionOptions& options, const DeviceSetup& setup) {
  if (options.passive != Passive::coupling) return 0;
  const double delay = static_cast<double>(setup.delay) * setup.period;
  const double limit = passive_stiffness({setup.period, delay, HandParameters::device_damping});
  return setup.coupling.stiffness_scale() / limit;
}

}  // namespace

SessionResult run_session(const SessionOptions& options) {
  const LoadedModel loaded = load_model(options.model);
  const Model& model = loaded.model;
  SessionResult result;
  const Elastostatic::Intent intent = Elastostatic::intended(model);
  result.rate = rate_of(options, intent);
  std::optional<Motions> motions;
  if (!options.motions.empty()) motions.emplace(options.motions, result.rate);
  const Agreement agreement = motions ? motions->agree(options, model) : agree(options, model);
  const bool gravity = model.view().has_gravity();
  if (options.script == Script::tilt && !gravity) {
    throw std::runtime_error(options.model.string() + ": --script tilt: the model knows no gravity; build it from a " +
                             "scene with gravity = true");
  }
  result.share = options.share.value_or(intent.share);
  result.least_work = agreement.least_work;
  result.budget = agreement.budget;
  const BodySurface surface = body_surface(model);
  const std::int64_t fast = steps_between(options, result.rate);
  const double device_rate = static_cast<double>(fast) * result.rate;
  if (fast > 1 && motions) throw std::runtime_error("--fast-rate: a local model knows no motions between steps");
  DeviceSetup setup = device_setup(options, device_rate, surface, *model.view().info);
  if (motions) setup.impulses = ImpulseSchedule(motions->impulses(), device_rate);
  HapticDevice device(setup);
  result.tools = device.state().num_tools;
  if (fast > 1 && result.tools > LocalModel::most_tools) {
    throw std::runtime_error("--fast-rate: a local model has at most 3 tools; give --tools 3 or less");
  }
  result.device_period = setup.period;
  result.cycles_asked = setup.cycles;
  result.log = RunLog(static_cast<std::size_t>(result.cycles_asked), model.node_count(), options.keep_records);

  std::optional<HostedContactBody> body, reference;
  if (motions) {
    motions->create(model, agreement.limits);
  } else {
    body.emplace(model, agreement.limits);
  }
  if (fast > 1) reference.emplace(model, agreement.limits);
  const Budget tenth{std::max(result.budget.work / 10, agreement.least_work)};
  ControlLoop loop(motions ? motions->body().contact() : body->body(),
                   {.probe_radius = probe_size(surface).radius,
                    .friction = options.friction,
                    .compliance = coupling_compliance(options, setup),
                    .gravity = gravity,
                    .budget = result.budget,
                    .starved = options.script == Script::random ? tenth : Budget{},
                    .fast = fast,
                    .vibrating = motions ? &motions->body() : nullptr,
                    .reference = reference ? &reference->body() : nullptr,
                    .field_every = options.field_every.value_or(1),
                    .overrun_cycle = options.overrun_cycle});
  choose_transport(options.transport, result);
  run_link(device, loop, result.log, result);
  result.device = device.summary();
  return result;
}

}  // namespace greenloop
