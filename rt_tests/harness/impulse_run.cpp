#include "rt_tests/harness/impulse_run.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {
namespace {

using Cycle = ImpulseScript::Cycle;
using Response = ImpulseResponse::Response;

void add(std::span<const float> values, Fnv1a& digest) {
  for (const float x : values) digest.add_word(std::bit_cast<std::uint32_t>(x));
}

void add(std::span<const Vec3> vectors, Fnv1a& digest) {
  for (const Vec3& v : vectors) {
    for (const float x : {v.x, v.y, v.z}) digest.add_word(std::bit_cast<std::uint32_t>(x));
  }
}

std::uint64_t digest_of(const ImpulseBuffers& buffers) {
  Fnv1a digest;
  add(buffers.coordinate, digest);
  add(buffers.velocity, digest);
  add(buffers.displacement, digest);
  add(buffers.displacement_rate, digest);
  add(buffers.colour, digest);
  return digest.value();
}

void add_report(const ImpulseResponse::StepReport& report, Fnv1a& digest) {
  for (const std::uint64_t word :
       {static_cast<std::uint64_t>(report.status), report.work, std::uint64_t{report.orbit}, std::uint64_t{report.row},
        std::uint64_t{report.impulse}, std::uint64_t{report.modes}, std::uint64_t{report.planes},
        std::uint64_t{report.transfer_modes}, std::uint64_t{report.at_rest ? 1U : 0U}}) {
    digest.add_word(word);
  }
  for (const float x : {report.truncation_error, report.transfer_error, report.distance, report.blend}) {
    digest.add_word(std::bit_cast<std::uint32_t>(x));
  }
}

bool is_finite(std::span<const Vec3> vectors) {
  for (const Vec3& v : vectors) {
    if (!std::isfinite(v.x + v.y + v.z)) return false;
  }
  return true;
}

// what is wrong with a cycle's input itself
struct Faults {
  bool unknown = false;  // an impulse or a vertex that there is not
  bool size = false;     // of a buffer
  bool light = false;    // that is none
};

Faults faults_of(const Cycle& cycle, const ImpulseResponseView& view) {
  const std::uint32_t vertices = view.info->vertices;
  Faults faults = {cycle.impulse != ImpulseResponse::no_impulse && cycle.impulse >= view.info->impulses,
                   cycle.vertices > vertices || cycle.missing > 0,
                   cycle.lit && cycle.chosen_count + cycle.vertices > 0 && !std::isfinite(cycle.light.red[0])};
  for (std::uint32_t i = 0; i < cycle.chosen_count; ++i) faults.unknown |= cycle.chosen[i] >= vertices;
  return faults;
}

// below the worst case; chosen vertices take as much as sixteen others, and may take more than that
bool is_short(const Cycle& cycle, const ImpulseResponseView& view, const ImpulseResponse::Requirement& need) {
  return cycle.budget.work < need.worst_work ||
         std::uint64_t{cycle.chosen_count} * layout::block_vertices > view.info->vertices;
}

// whether a cycle may have ended so
bool may_be(Status status, const Cycle& cycle, bool legal, const ImpulseResponseView& view,
            const ImpulseResponse::Requirement& need) {
  const Faults faults = faults_of(cycle, view);
  switch (status) {
    case Status::held_out_of_range:
      return faults.unknown;
    case Status::held_illegal_impulse:
      return !legal;
    case Status::held_response_size:
      return faults.size;
    case Status::held_not_finite:
      return faults.light;
    case Status::held_over_budget:
      return is_short(cycle, view, need);
    default:
      return answered(status) && !faults.unknown && !faults.size && !faults.light && legal &&
             cycle.budget.work >= need.least_work;
  }
}

}  // namespace

Response response_of(const Cycle& cycle, const ImpulseBuffers& buffers) {
  const std::uint32_t count = cycle.chosen_count > 0 ? cycle.chosen_count : cycle.vertices;
  return {buffers.coordinate.first(buffers.coordinate.size() - cycle.missing),
          buffers.velocity,
          buffers.displacement.first(count),
          cycle.rates ? buffers.displacement_rate.first(count) : std::span<Vec3>(),
          {cycle.chosen, cycle.chosen_count},
          cycle.lit ? buffers.colour.first(count) : std::span<Vec3>(),
          &cycle.light};
}

bool may_be_refused(const Cycle& cycle, bool legal, const ImpulseResponseView& view,
                    const ImpulseResponse::Requirement& need) {
  const Faults faults = faults_of(cycle, view);
  return faults.unknown || faults.size || faults.light || !legal || is_short(cycle, view, need);
}

const char* what_is_wrong(const Cycle& cycle, const ImpulseResponse::StepReport& report, bool legal,
                          const ImpulseResponseView& view, const ImpulseResponse::Requirement& need,
                          const Response& response) {
  if (report.work > cycle.budget.work || report.work > need.worst_work) return "a step took more than its budget";
  if (!may_be(report.status, cycle, legal, view, need)) {
    return answered(report.status) ? "a step was answered that should not be" : "a step was refused that should not be";
  }
  if (!answered(report.status)) return nullptr;
  if (!std::isfinite(state_energy(view, response.coordinate, response.velocity))) return "a state is not finite";
  if (!is_finite(response.colour)) return "a colour is not finite";
  const bool finite = is_finite(response.displacement) && is_finite(response.displacement_rate);
  return finite ? nullptr : "a displacement is not finite";
}

double state_energy(const ImpulseResponseView& view, std::span<const float> coordinate,
                    std::span<const float> velocity) {
  double energy = 0;
  const auto balance = static_cast<double>(view.info->velocity_balance);
  for (std::size_t m = 0; m < coordinate.size(); ++m) {
    const auto x = static_cast<double>(coordinate[m]), v = balance * static_cast<double>(velocity[m]);
    energy += x * x + v * v;
  }
  return energy;
}

ImpulseScript::ImpulseScript(const Model& model, const ImpulseResponse::Requirement& need, std::uint64_t seed) noexcept
    : impulses_(model.view().impulse_response.info->impulses),
      vertices_(model.view().impulse_response.info->vertices),
      lit_(model.view().impulse_response.appearance.modes > 0),
      need_(need),
      state_(seed * 2 + 1) {}

std::uint32_t ImpulseScript::below(std::uint32_t bound) noexcept {
  state_ = state_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((state_ >> 33) * bound >> 31);
}

void ImpulseScript::shine(Light& light) noexcept {
  for (float* const colour : {light.red, light.green, light.blue}) {
    for (std::uint32_t i = 0; i < Light::coefficients; ++i)
      colour[i] = (static_cast<float>(below(4001)) - 2000) * 0x1p-10F;
  }
  if (below(40) == 0) light.red[0] = std::numeric_limits<float>::infinity();
}

ImpulseScript::Cycle ImpulseScript::next() noexcept {
  Cycle cycle;
  if (below(50) == 0) cycle.impulse = below(impulses_ + 1);
  const std::uint32_t asked = below(8);
  cycle.vertices = asked == 0                    ? vertices_
                   : asked == 1                  ? below(vertices_ + 1)
                   : asked == 2 && below(9) == 0 ? vertices_ + 1
                                                 : 0;
  if (asked == 3) {
    cycle.chosen_count = 1 + below(most_chosen);
    for (std::uint32_t i = 0; i < cycle.chosen_count; ++i)
      cycle.chosen[i] = below(vertices_ + (below(20) == 0 ? 1 : 0));
  }
  cycle.rates = below(4) == 0;
  cycle.lit = lit_ && below(2) == 0;
  if (cycle.lit) shine(cycle.light);
  const std::uint32_t much = below(8);
  cycle.budget.work = much == 0   ? need_.least_work - below(2)
                      : much == 1 ? need_.least_work + below(static_cast<std::uint32_t>(need_.worst_work))
                                  : need_.worst_work;
  return cycle;
}

ImpulseRun run_impulse_script(const Model& model, const ImpulseResponse::Limits& limits, std::span<std::byte> memory,
                              const ImpulseBuffers& buffers, std::uint64_t cycles, std::uint64_t seed,
                              bool flip) noexcept {
  ImpulseRun run;
  const ImpulseResponse::Requirement need = ImpulseResponse::required(model, limits);
  run.memory_bytes = need.bytes;
  auto created = ImpulseResponse::create(model, limits, memory);
  if (!created) {
    run.error = "the body was not created";
    return run;
  }
  const ImpulseResponseView& view = model.view().impulse_response;
  ImpulseScript script(model, need, seed);
  Fnv1a digest;
  std::uint64_t last = digest_of(buffers);
  for (; run.cycle < cycles && run.error == nullptr; ++run.cycle) {
    const Cycle cycle = script.next();
    const bool legal = cycle.impulse == ImpulseResponse::no_impulse || created.body.may_follow(cycle.impulse);
    const Response response = response_of(cycle, buffers);
    const auto report = created.body.step(cycle.impulse, cycle.budget, response);
    ++run.by_status[static_cast<std::size_t>(report.status)];
    run.entered += answered(report.status) && cycle.impulse != ImpulseResponse::no_impulse ? 1 : 0;
    add_report(report, digest);
    const std::uint64_t now = digest_of(buffers);
    digest.add_word(now ^ (flip && run.cycle == cycles / 2 ? 1U : 0U));
    run.error = what_is_wrong(cycle, report, legal, view, need, response);
    if (!answered(report.status) && now != last) run.error = "a refused step changed the answer";
    last = now;
  }
  run.digest = digest.value();
  return run;
}

}  // namespace greenloop
