#include "sim_hw/drag/drag_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/output/output_file.hpp"
#include "sim_hw/control_loop/status_name.hpp"

namespace greenloop {
namespace {

double dot(const Vec3& a, const Vec3& b) {
  return static_cast<double>(a.x) * static_cast<double>(b.x) + static_cast<double>(a.y) * static_cast<double>(b.y) +
         static_cast<double>(a.z) * static_cast<double>(b.z);
}

double length(const Vec3& v) { return std::sqrt(dot(v, v)); }

double per(double sum, std::int64_t count) { return count > 0 ? sum / static_cast<double>(count) : 0; }

/// N: what each vertex weighs, a quarter of the tetrahedra around.
std::vector<Vec3> weights_of(const MultigridView& view) {
  const auto point = [&](std::uint32_t v) {
    const float* const p = view.points + std::size_t{3} * v;
    return Vec3{p[0], p[1], p[2]};
  };
  const float* const g = view.info->gravity;
  std::vector<Vec3> weight(view.info->vertices);
  for (const layout::TetrahedronRecord& tetrahedron : view.tetrahedra) {
    Vec3 edge[3];
    const Vec3 corner = point(tetrahedron.vertex[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 other = point(tetrahedron.vertex[i + 1]);
      edge[i] = {other.x - corner.x, other.y - corner.y, other.z - corner.z};
    }
    const Vec3 cross{edge[1].y * edge[2].z - edge[1].z * edge[2].y, edge[1].z * edge[2].x - edge[1].x * edge[2].z,
                     edge[1].x * edge[2].y - edge[1].y * edge[2].x};
    const float mass = static_cast<float>(dot(edge[0], cross)) / 24 * view.matters[tetrahedron.matter].density;
    for (const std::uint32_t v : tetrahedron.vertex) {
      weight[v] = {weight[v].x + mass * g[0], weight[v].y + mass * g[1], weight[v].z + mass * g[2]};
    }
  }
  return weight;
}

}  // namespace

double DragTally::mean_residual() const { return per(residual_sum, cycles - refused - misses); }

double DragTally::mean_multigrid_cycles() const {
  return per(static_cast<double>(multigrid_cycles), cycles - refused - misses);
}

DragLog::DragLog(const MultigridView& view, std::size_t cycles, bool keep)
    : weight_(weights_of(view)), dragged_(view.info->shown) {
  if (keep) records_.reserve(cycles);
  cpu_us_.reserve(cycles);
}

double DragLog::weighed(std::span<const Vec3> displacement) const noexcept {
  double sum = 0;
  for (std::size_t v = 0; v < weight_.size(); ++v) sum -= dot(weight_[v], displacement[v]);
  return sum;
}

void DragLog::count(const DragLoop& loop) noexcept {
  const Multigrid::StepReport& report = loop.report();
  const bool over = report.work > loop.budget().work || report.status == Status::held_over_budget;
  if (over && tally_.misses++ == 0) tally_.first_miss = loop.state().cycle;
  tally_.worst_work = std::max(tally_.worst_work, report.work);
  const bool holds = loop.state().vertex >= 0;
  tally_.grasps += holds && loop.state().vertex != held_ ? 1 : 0;
  tally_.refused += !over && !answered(report.status) ? 1 : 0;
  tally_.coarser += report.status == Status::coarser ? 1 : 0;
  if (!answered(report.status)) return;
  tally_.multigrid_cycles += report.cycles;
  tally_.most_multigrid_cycles = std::max(tally_.most_multigrid_cycles, report.cycles);
  tally_.residual = std::max(tally_.residual, static_cast<double>(report.residual));
  tally_.residual_sum += static_cast<double>(report.residual);
}

void DragLog::measure(const DragLoop& loop, const Multigrid::Energy& energy, double farthest) noexcept {
  const bool holds = loop.state().vertex >= 0;
  if (holds && loop.state().vertex == held_) {
    const Vec3 moved{loop.hold().displacement.x - place_.x, loop.hold().displacement.y - place_.y,
                     loop.hold().displacement.z - place_.z};
    done_ += 0.5 * (dot(force_, moved) + dot(loop.force(), moved));
  }
  force_ = loop.force();
  place_ = loop.hold().displacement;
  held_ = loop.state().vertex;
  const double force = length(force_);
  if (loop.displays() && force > dragged_force_) {
    dragged_force_ = force;
    std::copy(loop.shown().begin(), loop.shown().end(), dragged_.begin());
  }
  const auto kinetic = static_cast<double>(energy.kinetic), elastic = static_cast<double>(energy.elastic);
  tally_.force = std::max(tally_.force, force);
  tally_.farthest = std::max(tally_.farthest, farthest);
  tally_.kinetic = std::max(tally_.kinetic, kinetic);
  tally_.elastic = std::max(tally_.elastic, elastic);
  tally_.kinetic_left = kinetic;
  tally_.gain = std::max(tally_.gain, kinetic + elastic + weighed(loop.displacement()) - done_);
}

void DragLog::add(const DragLoop& loop, std::int64_t cycle, double cpu_us) noexcept {
  if (cpu_us_.size() == cpu_us_.capacity()) return;
  cpu_us_.push_back(static_cast<float>(cpu_us));
  ++tally_.cycles;
  count(loop);
  double farthest = 0;
  for (const Vec3& v : loop.displacement()) farthest = std::max(farthest, dot(v, v));
  farthest = std::sqrt(farthest);
  const Multigrid::Energy energy = loop.energy();
  measure(loop, energy, farthest);
  if (records_.size() == records_.capacity()) return;
  records_.push_back({cycle, loop.state().vertex, length(loop.force()), farthest, energy, loop.report()});
}

void DragLog::write_trace(const std::filesystem::path& file, double period, std::uint64_t budget) const {
  OutputFile out(file);
  out.write("time,vertex,force,displacement,kinetic,elastic,residual,cycles,work,budget,status\n");
  for (const DragRecord& r : records_) {
    out.write(fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", static_cast<double>(r.cycle) * period, r.vertex,
                          r.force, r.farthest, r.energy.kinetic, r.energy.elastic, r.report.residual, r.report.cycles,
                          r.report.work, budget, name(r.report.status)));
  }
  out.close();
}

void DragLog::write_snapshot(const std::filesystem::path& file) const {
  OutputFile out(file);
  out.write("x,y,z\n");
  for (const Vec3& v : dragged_) out.write(fmt::format("{},{},{}\n", v.x, v.y, v.z));
  out.close();
}

}  // namespace greenloop
