#include "runtime/impulse_response.hpp"

#include <cstddef>
#include <new>

#include "runtime/algebra/processor.hpp"
#include "runtime/impulse_response/appearance.hpp"
#include "runtime/impulse_response/mode_sums.hpp"
#include "runtime/impulse_response/moving_body.hpp"
#include "runtime/memory/fit.hpp"

namespace greenloop {
namespace {

using layout::block_values;
using layout::block_vertices;

/// What limits and model make of the time of a loop.
struct Timing {
  std::uint64_t ticks = 0;  // 2^-32 of the model's time steps a step
  float decay = 0;          // of differences in a step
};

// exp(-x) for x >= 0 by its series, on 2^-10 of it: the same on every target
double decay_of(double x) {
  const double part = x * 0x1p-10;
  double sum = 1, term = 1;
  for (int k = 1; k <= 12; ++k) {
    term *= -part / k;
    sum += term;
  }
  for (int k = 0; k < 10; ++k) sum *= sum;
  return sum;
}

bool in_range(const ImpulseResponse::Limits& limits) {
  const bool rate = limits.rate == 0 || (limits.rate >= 0x1p-10F && limits.rate <= 0x1p+24F);
  const bool blend = limits.blend_rate == 0 || (limits.blend_rate >= 0x1p-10F && limits.blend_rate <= 0x1p+24F);
  return rate && blend && limits.stretch >= 0x1p-6F && limits.stretch <= 0x1p+6F;
}

// false: refused
bool time_steps(const ImpulseResponseView& view, const ImpulseResponse::Limits& limits, Timing& timing) {
  if (!in_range(limits)) return false;
  const layout::ImpulseInfo& info = *view.info;
  const double period = 1.0 / static_cast<double>(limits.rate > 0 ? limits.rate : info.rate);
  const double lambda = static_cast<double>(limits.blend_rate > 0 ? limits.blend_rate : info.blend_rate);
  const double steps = period * static_cast<double>(limits.stretch) / info.time_step;
  if (!(steps <= OrbitPlayer::most_rows) || !(steps >= 0x1p-30)) return false;
  constexpr double dies_at_once = 100;
  const double decay = lambda * period > dies_at_once ? 0 : decay_of(lambda * period);
  timing = {static_cast<std::uint64_t>(steps * 0x1p+32), static_cast<float>(decay)};
  return true;
}

bool is_playable(const Model& model) { return model.problem() == layout::Problem::impulse_response; }

// what a response asks for
struct Wanted {
  std::uint32_t fields = 0;
  std::uint32_t vertices = 0;
  bool chosen = false;
  bool lit = false;

  [[nodiscard]] std::uint64_t work(const ImpulseResponseView& view, Fineness fineness) const {
    if (fields == 0) return 0;
    return chosen ? chosen_work(view, vertices, fields, fineness) : field_work(view, vertices, fields, fineness);
  }
  [[nodiscard]] std::uint64_t work_of_colours(std::uint32_t transfer_modes) const {
    if (!lit) return 0;
    return chosen ? chosen_colour_work(vertices, transfer_modes) : colour_work(vertices, transfer_modes);
  }
};

// how finely an answer is summed; without a pair of modes it cannot be given
struct Answer {
  Fineness fineness;
  std::uint32_t transfer_modes = 0;

  [[nodiscard]] std::uint64_t work(const ImpulseResponseView& view, const Wanted& wanted) const {
    return wanted.work(view, fineness) + wanted.work_of_colours(transfer_modes);
  }
};

Status check_colours(const MovingBody& body, const ImpulseResponse::Response& response) {
  if (response.colour.empty()) return Status::ok;
  if (response.light == nullptr || body.view.appearance.modes == 0) return Status::held_response_size;
  return is_light(*response.light) ? Status::ok : Status::held_not_finite;
}

Status check_response(const MovingBody& body, const ImpulseResponse::Response& response, Wanted& wanted) {
  const std::size_t modes = body.view.modes, most = body.view.info->vertices;
  const auto fits = [](std::size_t size, std::size_t expected) { return size == 0 || size == expected; };
  const std::size_t moved = response.displacement.size(), rates = response.displacement_rate.size();
  const std::size_t colours = response.colour.size();
  const std::size_t vertices = moved > 0 ? moved : rates > 0 ? rates : colours;
  if (!fits(response.coordinate.size(), modes) || !fits(response.velocity.size(), modes)) {
    return Status::held_response_size;
  }
  if (!fits(rates, vertices) || !fits(colours, vertices) || vertices > most ||
      !fits(response.chosen.size(), vertices)) {
    return Status::held_response_size;
  }
  for (const std::uint32_t vertex : response.chosen) {
    if (vertex >= most) return Status::held_out_of_range;
  }
  wanted = {(moved > 0 ? 1U : 0U) + (rates > 0 ? 1U : 0U), static_cast<std::uint32_t>(vertices),
            !response.chosen.empty(), colours > 0};
  return check_colours(body, response);
}

// all modes with all planes, or with one, or as many as fit; no pair: not even one does
Fineness choose_fineness(const MovingBody& body, const Wanted& wanted, std::uint64_t work) {
  const ImpulseResponseView& view = body.view;
  const std::uint32_t pairs = view.modes / 2, planes = view.info->planes;
  if (wanted.work(view, {pairs, planes}) <= work) return {pairs, planes};
  if (wanted.work(view, {pairs, 1}) <= work) return {pairs, 1};
  const std::uint64_t least = wanted.work(view, {1, 1});
  if (least > work) return {};
  const std::uint64_t another = wanted.work(view, {2, 1}) - least;
  return {static_cast<std::uint32_t>(1 + (work - least) / another), 1};
}

// displacements as finely as colours by their mean alone leave room for, then colours by as many modes as fit
Answer choose_answer(const MovingBody& body, const Wanted& wanted, std::uint64_t work) {
  const std::uint64_t mean = wanted.work_of_colours(0);
  if (mean > work) return {};
  Answer answer = {choose_fineness(body, wanted, work - mean), 0};
  if (!wanted.lit || answer.fineness.pairs == 0) return answer;
  const std::uint64_t left = work - mean - wanted.work(body.view, answer.fineness);
  const std::uint64_t fit = left / (wanted.work_of_colours(1) - mean), all = body.view.appearance.modes;
  answer.transfer_modes = static_cast<std::uint32_t>(fit < all ? fit : all);
  return answer;
}

float transfer_error(const ImpulseResponseView& view, std::uint32_t modes) {
  return modes == 0 ? 1 : view.appearance.amplitudes[modes - 1].truncation_error;
}

float truncation_error(const ImpulseResponseView& view, std::uint32_t modes) {
  std::uint32_t left = modes - 1, q = 0;
  while (left >= view.group[q].counts->modes) left -= view.group[q++].counts->modes;
  return view.group[q].amplitudes[left].truncation_error;
}

void copy_amplitudes(const ImpulseResponseView& view, const float* c, std::span<float> to) {
  if (to.empty()) return;
  std::uint32_t mode = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t m = 0; m < view.group[q].counts->modes; ++m, ++mode) {
      to[mode] = c[mode] * view.group[q].amplitudes[m].amplitude;
    }
  }
}

void sum_chosen(const ImpulseResponseView& view, const WholeCoordinates& whole, std::span<const std::uint32_t> chosen,
                Vec3* to) {
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    float value[3];
    sum_modes_at(view, whole, chosen[i], value);
    to[i] = {value[0], value[1], value[2]};
  }
}

void sum_first(const MovingBody& body, const WholeCoordinates& whole, std::span<Vec3> to) {
  const auto vertices = static_cast<std::uint32_t>(to.size());
  const std::uint32_t blocks = vertices / block_vertices, rest = vertices % block_vertices;
  sum_modes(body.view, whole, 0, blocks, body.avx2, reinterpret_cast<float*>(to.data()));
  if (rest == 0) return;
  float values[block_values];
  sum_modes(body.view, whole, blocks, blocks + 1, body.avx2, values);
  for (std::uint32_t i = 0; i < rest; ++i) {
    to[std::size_t{blocks} * block_vertices + i] = {values[std::size_t{3} * i], values[std::size_t{3} * i + 1],
                                                    values[std::size_t{3} * i + 2]};
  }
}

void sum_field(const MovingBody& body, const float* c, Fineness fineness, std::span<const std::uint32_t> chosen,
               std::span<Vec3> to) {
  if (to.empty()) return;
  const WholeCoordinates whole = whole_coordinates(c, fineness.pairs, fineness.planes, body.whole);
  if (chosen.empty()) {
    sum_first(body, whole, to);
  } else {
    sum_chosen(body.view, whole, chosen, to.data());
  }
}

void sum_colours_of(const MovingBody& body, std::uint32_t modes, const ImpulseResponse::Response& response) {
  if (response.colour.empty()) return;
  const LitState lit = lit_state(*response.light, body.player.transfer(), modes, body.lit);
  if (response.chosen.empty()) {
    sum_colours(body.view, lit, static_cast<std::uint32_t>(response.colour.size()), body.avx2, response.colour.data());
    return;
  }
  for (std::size_t i = 0; i < response.chosen.size(); ++i)
    response.colour[i] = colour_at(body.view, lit, response.chosen[i]);
}

Status check_impulse(const MovingBody& body, std::uint32_t impulse) {
  if (impulse == ImpulseResponse::no_impulse) return Status::ok;
  if (impulse >= body.view.info->impulses) return Status::held_out_of_range;
  return body.player.reference(impulse).orbit == layout::none ? Status::held_illegal_impulse : Status::ok;
}

}  // namespace

ImpulseResponse::Requirement ImpulseResponse::required(const Model& model, const Limits& limits) noexcept {
  Timing timing;
  const ImpulseResponseView& view = model.view().impulse_response;
  if (!is_playable(model) || !time_steps(view, limits, timing)) return {};
  Arena counting;
  static_cast<void>(place_body(counting, view));
  Requirement requirement;
  requirement.bytes = static_cast<std::size_t>(counting.bytes());
  requirement.least_work = state_work(view, 1, most_continuations(view, timing.ticks));
  const Fineness all = {view.modes / 2, view.info->planes};
  requirement.least_frame_work = requirement.least_work + field_work(view, view.info->vertices, 1, {1, 1});
  requirement.frame_work = requirement.least_work + field_work(view, view.info->vertices, 1, all);
  if (view.appearance.modes > 0) requirement.colour_work = colour_work(view.info->vertices, view.appearance.modes);
  requirement.worst_work =
      requirement.least_work + field_work(view, view.info->vertices, 2, all) + requirement.colour_work;
  return requirement;
}

ImpulseResponse::Created ImpulseResponse::create(const Model& model, const Limits& limits,
                                                 std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  Timing timing;
  const ImpulseResponseView& view = model.view().impulse_response;
  if (!is_playable(model)) {
    created.error = CreateError::unsupported_model;
    return created;
  }
  if (!time_steps(view, limits, timing)) {
    created.error = CreateError::bad_limits;
    return created;
  }
  const Requirement requirement = required(model, limits);
  created.requested = requirement.bytes;
  if (!memory_fits(memory, CreateError::arena_too_small, CreateError::arena_misaligned, created)) return created;
  Arena arena(memory.data());
  MovingBody& body = *place_body(arena, view);
#if defined(__x86_64__)
  body.avx2 = has_avx2();
#endif
  body.least_work = requirement.least_work;
  body.worst_work = requirement.worst_work;
  body.player.begin(timing.ticks, timing.decay, static_cast<float>(view.info->time_step));
  created.body.body_ = &body;
  return created;
}

bool ImpulseResponse::may_follow(std::uint32_t impulse) const noexcept {
  return impulse != no_impulse && check_impulse(*body_, impulse) == Status::ok;
}

ImpulseResponse::StepReport ImpulseResponse::step(std::uint32_t impulse, Budget budget,
                                                  const Response& response) noexcept {
  MovingBody& body = *body_;
  StepReport report;
  Wanted wanted;
  report.status = check_impulse(body, impulse);
  if (report.status == Status::ok) report.status = check_response(body, response, wanted);
  const std::uint64_t most = budget.work < body.worst_work ? budget.work : body.worst_work;
  const std::uint64_t left = most > body.least_work ? most - body.least_work : 0;
  const Answer answer = choose_answer(body, wanted, left);
  const Fineness fineness = answer.fineness;
  if (report.status == Status::ok && (budget.work < body.least_work || fineness.pairs == 0)) {
    report.status = Status::held_over_budget;
  }
  if (!answered(report.status)) return report;

  if (impulse != no_impulse) {
    const layout::ReferenceRecord reference = body.player.reference(impulse);
    body.player.enter(reference.orbit);
    report.distance = reference.distance;
  }
  const Continuations passed = body.player.pass();
  report.distance = passed.distance > report.distance ? passed.distance : report.distance;
  copy_amplitudes(body.view, body.player.position(), response.coordinate);
  copy_amplitudes(body.view, body.player.velocity(), response.velocity);
  sum_field(body, body.player.position(), fineness, response.chosen, response.displacement);
  sum_field(body, body.player.velocity(), fineness, response.chosen, response.displacement_rate);
  sum_colours_of(body, answer.transfer_modes, response);

  const bool coarser = fineness.pairs < body.view.modes / 2 || fineness.planes < body.view.info->planes ||
                       (wanted.lit && answer.transfer_modes < body.view.appearance.modes);
  report.status = coarser ? Status::coarser : Status::ok;
  report.work = state_work(body.view, impulse != no_impulse ? 1 : 0, passed.count) + answer.work(body.view, wanted);
  report.orbit = body.player.place().orbit;
  report.row = body.player.place().row;
  report.impulse = body.player.orbit().impulse;
  if (wanted.fields > 0) {
    report.modes = 2 * fineness.pairs;
    report.planes = fineness.planes;
    report.truncation_error = truncation_error(body.view, report.modes);
  }
  if (wanted.lit) {
    report.transfer_modes = answer.transfer_modes;
    report.transfer_error = transfer_error(body.view, answer.transfer_modes);
  }
  report.blend = body.player.blend();
  report.at_rest = body.player.at_rest();
  return report;
}

}  // namespace greenloop
