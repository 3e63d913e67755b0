#include "rt_tests/stress/impulse_stress_script.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace greenloop {
namespace {

constexpr auto unlimited = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t no_impulse = ImpulseResponse::no_impulse;

}  // namespace

ImpulseStressScript::ImpulseStressScript(const Model& model, const ImpulseResponse::Requirement& need,
                                         ImpulseScriptKind kind, std::uint64_t seed)
    : mixed_(model, need, seed),
      kind_(kind),
      lit_(model.view().impulse_response.appearance.modes > 0),
      impulses_(model.view().impulse_response.info->impulses),
      vertices_(model.view().impulse_response.info->vertices),
      modes_(model.view().impulse_response.modes),
      time_step_(model.view().impulse_response.info->time_step),
      rate_(static_cast<double>(model.view().impulse_response.info->rate)),
      need_(need),
      state_(2 * seed + 1) {}

std::uint32_t ImpulseStressScript::below(std::uint32_t bound) {
  state_ = state_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((state_ >> 33U) * bound >> 31U);
}

double ImpulseStressScript::between(double least, double most) {
  const std::uint32_t end = below(6);
  if (end < 2) return end == 0 ? least : most;
  return least * std::pow(most / least, below(1U << 20U) * 0x1p-20);
}

// one that may follow; none: none may
std::uint32_t ImpulseStressScript::legal_impulse(const ImpulseResponse& body) {
  const std::uint32_t first = below(impulses_);
  for (std::uint32_t i = 0; i < impulses_; ++i) {
    const std::uint32_t impulse = (first + i) % impulses_;
    if (body.may_follow(impulse)) return impulse;
  }
  return no_impulse;
}

// something is wrong with the cycle, but for impulses where every one may follow
void ImpulseStressScript::spoil(const ImpulseResponse& body, ImpulseScript::Cycle& cycle) {
  switch (below(6)) {
    case 0:
      cycle.impulse = impulses_ + below(no_impulse - impulses_);
      break;
    case 1:
      for (std::uint32_t i = 0; i < impulses_; ++i) {
        if (!body.may_follow(i)) cycle.impulse = i;
      }
      break;
    case 2:
      cycle.missing = 1 + below(modes_ - 1);
      break;
    case 3:
      cycle.vertices = vertices_ + 1;
      break;
    case 4:
      cycle.chosen_count = 1 + below(ImpulseScript::most_chosen);
      std::fill_n(cycle.chosen, cycle.chosen_count, 0U);
      cycle.chosen[below(cycle.chosen_count)] = vertices_ + below(no_impulse - vertices_);
      break;
    default:
      cycle.budget.work = below(static_cast<std::uint32_t>(need_.least_work));
  }
}

std::uint64_t ImpulseStressScript::starved() {
  const std::uint64_t thresholds[] = {
      0, need_.least_work, need_.least_frame_work, need_.frame_work, need_.worst_work, unlimited};
  const std::uint32_t drawn = below(12);
  if (drawn < 6) return thresholds[drawn] - std::min<std::uint64_t>(thresholds[drawn], below(3));
  return need_.least_work + (need_.worst_work - need_.least_work) * below(1U << 20U) / (1U << 20U);
}

ImpulseScript::Cycle ImpulseStressScript::next(const ImpulseResponse& body) {
  if (kind_ == ImpulseScriptKind::mixed) return mixed_.next();
  ImpulseScript::Cycle cycle;
  cycle.budget.work = kind_ == ImpulseScriptKind::play ? need_.least_work : need_.worst_work;
  const bool every = kind_ == ImpulseScriptKind::storm || (kind_ == ImpulseScriptKind::paces && below(2) == 0);
  if (every || (kind_ != ImpulseScriptKind::play && below(20) == 0)) {
    cycle.impulse = legal_impulse(body);
  } else if (below(50) == 0) {
    cycle.impulse = below(impulses_ + 1);
  }
  if (kind_ == ImpulseScriptKind::garbage && below(4) != 0) spoil(body, cycle);
  if (kind_ == ImpulseScriptKind::starve || kind_ == ImpulseScriptKind::frames) {
    cycle.vertices = vertices_;
    cycle.rates = true;
  }
  if (kind_ == ImpulseScriptKind::starve) cycle.budget.work = starved();
  if (kind_ == ImpulseScriptKind::storm && below(8) == 0) {
    cycle.chosen_count = ImpulseScript::most_chosen;
    for (std::uint32_t& vertex : cycle.chosen) vertex = below(vertices_);
  }
  if (lit_ && cycle.vertices + cycle.chosen_count > 0) {
    cycle.lit = true;
    for (float* const colour : {cycle.light.red, cycle.light.green, cycle.light.blue}) {
      for (std::uint32_t i = 0; i < Light::coefficients; ++i)
        colour[i] = static_cast<float>(below(1U << 20U)) * 0x1p-19F - 1;
    }
    if (kind_ == ImpulseScriptKind::garbage && below(4) == 0)
      cycle.light.red[0] = std::numeric_limits<float>::quiet_NaN();
  }
  return cycle;
}

ImpulseResponse::Limits ImpulseStressScript::limits() {
  constexpr double widest = 64, most_states = 64;
  const double stretch = between(1 / widest, widest);
  const double slowest = stretch / (most_states * time_step_);
  const double rate = below(3) == 0 ? rate_ : between(slowest * 1.001, std::max(slowest * 2, 1e5));
  // by its model's rate a step may pass too many states
  return {.rate = static_cast<float>(std::max(rate, slowest * 1.001)),
          .stretch = static_cast<float>(stretch),
          .blend_rate = below(3) == 0 ? 0 : static_cast<float>(between(1.0 / 512, 1 << 20))};
}

}  // namespace greenloop
