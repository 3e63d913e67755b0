#include "rt_tests/stress/elastic_stress_script.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace greenloop {
namespace {

constexpr float gravity = 9.81F;  // m/s^2

/// m^3
double volume_of(const MultigridView& view) {
  double six = 0;
  for (const layout::TetrahedronRecord& tetrahedron : view.tetrahedra) {
    double edge[3][3];
    const float* const corner = view.points + std::size_t{3} * tetrahedron.vertex[0];
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const other = view.points + std::size_t{3} * tetrahedron.vertex[i + 1];
      for (std::size_t k = 0; k < 3; ++k) edge[i][k] = static_cast<double>(other[k] - corner[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      six += edge[0][k] * (edge[1][next] * edge[2][last] - edge[1][last] * edge[2][next]);
    }
  }
  return six / 6;
}

}  // namespace

ElasticStressScript::ElasticStressScript(const MultigridView& view, const Multigrid::Limits& limits,
                                         const Multigrid::Requirement& need, ElasticScriptKind kind, std::uint64_t seed)
    : kind_(kind),
      vertices_(view.info->vertices),
      free_(view.info->free),
      most_loads_(limits.max_loads),
      most_holds_(std::min(limits.max_holds, std::max(1U, view.info->free / 20))),
      need_(need),
      state_(seed * 2 + 1) {
  float softest = view.matters[0].mu, density = view.matters[0].density;
  for (std::uint32_t m = 1; m < view.info->matters; ++m) {
    softest = std::min(softest, view.matters[m].mu);
    density = std::max(density, view.matters[m].density);
  }
  const double volume = volume_of(view);
  const auto cell = static_cast<float>(std::cbrt(volume / view.info->tetrahedra));
  // what displaces a vertex by a part of a cell, and not more than the body weighs
  force_ = std::min(0.2F * softest * cell * cell, static_cast<float>(volume) * density * gravity);
  travel_ = 0.003F * cell;
}

std::uint32_t ElasticStressScript::below(std::uint32_t bound) {
  state_ = state_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((state_ >> 33U) * bound >> 31U);
}

float ElasticStressScript::between(float low, float high) {
  return low + (high - low) * static_cast<float>(below(1U << 20U)) * 0x1p-20F;
}

Vec3 ElasticStressScript::vector(float size) {
  return {between(-size, size), between(-size, size), between(-size, size)};
}

void ElasticStressScript::load(std::uint32_t count) {
  acting_.loads.clear();
  for (std::uint32_t i = 0; i < std::min(count, most_loads_); ++i) {
    acting_.loads.push_back({below(vertices_), vector(force_)});
  }
}

void ElasticStressScript::take_hold(std::span<const Vec3> displacement) {
  const std::uint32_t v = below(free_);
  const auto holds = [v](const Multigrid::Hold& hold) { return hold.vertex == v; };
  if (acting_.holds.size() == most_holds_ || std::any_of(acting_.holds.begin(), acting_.holds.end(), holds)) return;
  acting_.holds.push_back({v, displacement[v]});
  velocity_.push_back(vector(travel_));
}

void ElasticStressScript::lead() {
  for (std::size_t i = 0; i < acting_.holds.size(); ++i) {
    Vec3& at = acting_.holds[i].displacement;
    at = {at.x + velocity_[i].x, at.y + velocity_[i].y, at.z + velocity_[i].z};
  }
  if (below(50) == 0) {
    for (Vec3& v : velocity_) v = {-v.x, -v.y, -v.z};
  }
  if (!acting_.holds.empty() && below(150) == 0) {
    const std::uint32_t let_go = below(static_cast<std::uint32_t>(acting_.holds.size()));
    acting_.holds.erase(acting_.holds.begin() + let_go);
    velocity_.erase(velocity_.begin() + let_go);
  }
}

void ElasticStressScript::ask() {
  const bool all = kind_ == ElasticScriptKind::starve;
  given_.shown = all ? below(2) == 0 : below(8) == 0;
  given_.stress = all ? below(2) == 0 : below(16) == 0;
  given_.chosen.clear();
  given_.surplus = 0;
  if (below(8) == 0) given_.chosen = {below(vertices_), below(vertices_), below(vertices_)};
}

std::uint64_t ElasticStressScript::enough() const {
  return need_.least_work + (given_.shown ? need_.shown_work : 0) + (given_.stress ? need_.stress_work : 0);
}

std::uint64_t ElasticStressScript::starved() {
  constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t thresholds[] = {0,
                                      1,
                                      enough() / 2,
                                      enough() - 1,
                                      enough(),
                                      enough() + 1,
                                      enough() + need_.cycle_work - 1,
                                      enough() + need_.cycle_work,
                                      enough() + need_.cycle_work * below(8),
                                      unlimited};
  return thresholds[below(static_cast<std::uint32_t>(std::size(thresholds)))];
}

// one thing that is wrong, in what was right
void ElasticStressScript::spoil() {
  constexpr float none[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()};
  const float rubbish = none[below(3)];
  if (given_.loads.empty()) given_.loads.push_back({below(vertices_), vector(force_)});
  if (given_.holds.empty()) given_.holds.push_back({below(free_), {}});
  switch (below(9)) {
    case 0:
      given_.loads.back().force.y = rubbish;
      break;
    case 1:
      given_.loads.back().vertex = vertices_ + below(2) * 0xffff;
      break;
    case 2:
      given_.holds.back().displacement.z = rubbish;
      break;
    case 3:
      given_.holds.back().vertex = below(2) == 0 ? vertices_ : 0xffffffff;
      break;
    case 4:
      given_.holds.push_back(given_.holds.front());
      break;
    case 5:
      given_.turned = true;
      given_.gravity.x = rubbish;
      break;
    case 6:
      given_.surplus = 1;
      break;
    case 7:
      given_.chosen = {0, vertices_};
      break;
    default:
      given_.loads.assign(most_loads_ + std::size_t{1}, {0, {}});
  }
}

void ElasticStressScript::exaggerate() {
  const auto size = static_cast<float>(std::pow(10.0, static_cast<double>(between(0, 38.5F))));
  switch (below(4)) {
    case 0:
      given_.turned = true;
      given_.gravity = vector(size);
      break;
    case 1:
      given_.holds = {{below(free_), vector(size)}};
      break;
    default:
      given_.loads = {{below(vertices_), vector(size)}, {below(vertices_), vector(size)}};
  }
}

const ElasticCycle& ElasticStressScript::next(std::span<const Vec3> displacement) {
  using enum ElasticScriptKind;
  lead();
  if (kind_ == loads) load(most_loads_);
  if (kind_ == holds && below(10) == 0) take_hold(displacement);
  if (kind_ != loads && below(200) == 0) load(below(5));
  if (kind_ != loads && kind_ != holds && below(300) == 0 && acting_.holds.empty()) take_hold(displacement);
  if (kind_ == mixed && below(500) == 0) {
    acting_.turned = below(2) == 0;
    acting_.gravity = vector(gravity);
  }
  given_ = acting_;
  ask();
  const std::uint32_t much = below(20);
  given_.budget.work = much < 8    ? enough()
                       : much < 14 ? enough() + need_.cycle_work
                       : much < 19 ? enough() + 8 * need_.cycle_work
                                   : enough() / 2;
  if (kind_ == starve) given_.budget.work = starved();
  if (kind_ == garbage && below(2) == 0) spoil();
  if (kind_ == huge && below(20) == 0) exaggerate();
  return given_;
}

}  // namespace greenloop
