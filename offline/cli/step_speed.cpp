#include "offline/cli/step_speed.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/hosted/thread_clock.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t sites = 8;
constexpr std::size_t most_steps = 4000;
constexpr float depth = 0.001F;  // of the body's diagonal

using Contacts = std::vector<Constraint>;

std::vector<std::uint32_t> touchable_nodes(const Model& model) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t node = 0; node < model.node_count(); ++node) {
    if (model.is_touchable(node)) nodes.push_back(node);
  }
  return nodes;
}

float diagonal(const layout::Info& info) {
  float square = 0;
  for (int k = 0; k < 3; ++k) square += std::pow(info.box_max[k] - info.box_min[k], 2.0F);
  return std::sqrt(square);
}

float square_distance(const Vec3& a, const Vec3& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z);
}

Contacts held(std::span<const std::uint32_t> nodes, float displacement) {
  Contacts contacts;
  for (const std::uint32_t node : nodes) contacts.push_back({.node = node, .value = {0, 0, displacement}});
  return contacts;
}

// a patch that is pressed, stays, and moves on by a node; then as many nodes all over
void add_site(const Model& model, std::vector<std::uint32_t> nodes, std::size_t site, std::size_t count,
              std::vector<Contacts>& script) {
  const float displacement = depth * diagonal(*model.view().info);
  const std::size_t first = site * nodes.size() / (sites * count);
  std::vector<std::uint32_t> spread;
  for (std::size_t i = 0; i < count; ++i) spread.push_back(nodes[(first + i * nodes.size() / count) % nodes.size()]);
  const Vec3 centre = model.position(nodes[site * nodes.size() / sites]);
  std::sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
    return square_distance(model.position(a), centre) < square_distance(model.position(b), centre);
  });
  const std::span<const std::uint32_t> near(nodes);
  script.push_back(held(near.first(count), displacement));
  script.push_back(held(near.first(count), 2 * displacement));
  script.push_back(held(near.subspan(nodes.size() > count ? 1 : 0, count), 2 * displacement));
  script.push_back(held(spread, displacement));
}

std::vector<Contacts> script_of(const Model& model, std::size_t most_contacts) {
  const std::vector<std::uint32_t> nodes = touchable_nodes(model);
  std::vector<Contacts> script;
  const std::size_t count = std::min(most_contacts, nodes.size());
  for (std::size_t site = 0; site < sites && count > 0; ++site) add_site(model, nodes, site, count, script);
  return script;
}

// microseconds per unit of each step that was answered, in rising order; of the script again and again
std::vector<double> time_steps(const Model& model, Elastostatic body, const std::vector<Contacts>& script,
                               Budget budget, double seconds) {
  AlignedBytes field(sizeof(Vec4) * model.node_count());
  const std::span<Vec4> displacement(reinterpret_cast<Vec4*>(field.data()), model.node_count());
  std::vector<Vec3> force(script.empty() ? 0 : script.front().size());
  const auto end = thread_nanoseconds() + static_cast<std::int64_t>(1e9 * seconds);
  std::vector<double> us_per_unit;
  for (std::size_t i = 0; i < most_steps && !script.empty() && (i < 2 || thread_nanoseconds() < end); ++i) {
    const std::int64_t begin = thread_nanoseconds();
    const auto report = body.step(script[i % script.size()], budget, {force, displacement});
    const auto ns = static_cast<double>(thread_nanoseconds() - begin);
    if (i > 0 && answered(report.status)) us_per_unit.push_back(1e-3 * ns / static_cast<double>(report.work));
  }
  std::sort(us_per_unit.begin(), us_per_unit.end());
  return us_per_unit;
}

double quantile(const std::vector<double>& rising, double share) {
  return rising.empty() ? 0 : rising[static_cast<std::size_t>(share * static_cast<double>(rising.size() - 1))];
}

}  // namespace

std::optional<StepSpeed> measure_speed(const Model& model, const Elastostatic::Limits& limits, Budget budget,
                                       double seconds) {
  AlignedBytes arena(Elastostatic::required(model, limits).bytes);
  const std::int64_t begin = thread_nanoseconds();
  const auto created = Elastostatic::create(model, limits, {arena.data(), arena.size()});
  const std::int64_t end = thread_nanoseconds();
  if (!created) return std::nullopt;
  const std::vector<Contacts> script = script_of(model, limits.max_contacts);
  const std::vector<double> us_per_unit = time_steps(model, created.body, script, budget, seconds);
  return StepSpeed{.create_ms = 1e-6 * static_cast<double>(end - begin),
                   .us_per_unit = quantile(us_per_unit, 0.5),
                   .us_per_unit_p95 = quantile(us_per_unit, 0.95),
                   .steps = us_per_unit.size()};
}

}  // namespace greenloop::offline
