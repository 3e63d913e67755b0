#include "offline/pipeline/simulate_scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/mesh/coarse_mesh.hpp"
#include "formats/mesh/surface_io.hpp"
#include "formats/trajectory/trajectory_file.hpp"
#include "offline/pipeline/body_geometry.hpp"
#include "offline/simulate/sampling.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

std::vector<std::uint8_t> fixed_vertices(const Scene& scene, const std::vector<Eigen::Vector3d>& vertices) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : vertices) box.extend(vertex);
  const auto fixed = evaluate(scene.fixed, vertices, box);
  return {fixed.begin(), fixed.end()};
}

std::vector<std::uint32_t> flat(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

std::vector<Impulse> palette_of(const Simulation& simulation) {
  std::vector<Impulse> palette;
  for (const auto& impulse : simulation.impulses) {
    const Eigen::Vector3d v = impulse.velocity();
    const std::array<double, 4> motion{v.x(), v.y(), v.z(), impulse.turning};
    palette.push_back(simulation.sheet ? Impulse{impulse.name, motion, motion} : Impulse{impulse.name, motion, {}});
  }
  return palette;
}

/// A simulator, and what a record and a file say of it.
struct Simulated {
  std::unique_ptr<Simulator> simulator;
  nlohmann::json record;      // beside what was played
  nlohmann::json provenance;  // beside the scene
};

Simulated make_solid(const Scene& scene, ProgressBar& progress) {
  auto body = make_elastic_solid(scene, progress);
  progress.begin("dynamics");
  const auto tetrahedra = body.mesh.tetrahedra.size(), vertices = body.mesh.vertices.size();
  auto solid = std::make_unique<ElasticSolid>(std::move(body));
  const double frequency = solid->lowest_frequency() / (2 * std::numbers::pi);
  progress.end(fmt::format("slowest vibration {:.3g} Hz", frequency));
  // a mesh's tetrahedra may differ from machine to machine, so that their count belongs to what a file is of
  return {std::move(solid),
          {{"tetrahedra", tetrahedra}, {"simulated_vertices", vertices}, {"lowest_frequency_hz", frequency}},
          {{"tetrahedra", tetrahedra}}};
}

Simulated make_sheets(const Scene& scene, ProgressBar& progress) {
  progress.begin("settling");
  auto sheets = std::make_unique<ThinSheets>(make_sheet_scene(scene));
  progress.end(fmt::format("{} vertices", sheets->vertices()));
  return {std::move(sheets), nlohmann::json::object(), nlohmann::json::object()};
}

SamplingPlan plan_of(const Simulation& s) {
  SamplingPlan plan{s.coverage ? Sampling::coverage : Sampling::random,
                    s.orbits,
                    s.held_out,
                    s.shortest,
                    s.longest,
                    s.to_rest,
                    s.longest_to_rest,
                    s.seed,
                    {},
                    s.replay_goal};
  for (const auto& impulse : s.impulses) plan.longest_of.push_back(impulse.longest);
  return plan;
}

std::string provenance_of(const Scene& scene, nlohmann::json provenance) {
  provenance["program"] = "greenloop simulate";
  provenance["scene"] = canonical_text(scene);
  return provenance.dump();
}

bool is_same(const TrajectoryScene& a, const TrajectoryScene& b) {
  return a.time_step == b.time_step && a.rest == b.rest && a.triangles == b.triangles &&
         a.successions == b.successions && a.provenance == b.provenance;
}

TrajectoryWriter open_or_create(const SimulateRequest& request, const TrajectoryScene& scene, TrajectoryRoom room,
                                const std::filesystem::path& states) {
  if (request.overwrite) {
    std::filesystem::remove(request.trajectories);
    std::filesystem::remove(states);
  }
  if (!std::filesystem::exists(request.trajectories)) {
    std::filesystem::remove(states);
    return TrajectoryWriter::create(request.trajectories, scene, room);
  }
  auto file = TrajectoryWriter::resume(request.trajectories);
  if (!is_same(file.scene(), scene)) {
    throw std::runtime_error(
        request.trajectories.string() +
        ": holds trajectories of another scene; name another file, or replace it with --overwrite");
  }
  return file;
}

nlohmann::json record_of(const TrajectoryScene& file, nlohmann::json record) {
  std::uint64_t frames = 0, at_rest = 0, held_out = 0;
  for (const auto& orbit : file.orbits) {
    frames += orbit.frames;
    at_rest += orbit.at_rest ? 1 : 0;
    held_out += orbit.held_out ? 1 : 0;
  }
  record.update({{"vertices", file.vertices()},
                 {"orbits", file.orbits.size()},
                 {"held_out", held_out},
                 {"at_rest", at_rest},
                 {"frames", frames}});
  return record;
}

}  // namespace

ElasticSolidScene make_elastic_solid(const Scene& scene, ProgressBar& progress) {
  const Simulation& simulation = scene.simulation.value();
  const auto body = make_body_geometry(scene, progress);
  progress.begin("tetrahedra");
  auto filled = tetrahedra_within(body, std::min(simulation.level, body.surface.finest_level()));
  progress.end(fmt::format("{} tetrahedra, {} vertices, by {}", filled.mesh.tetrahedra.size(),
                           filled.mesh.vertices.size(), filled.mesher));
  ElasticSolidScene solid;
  solid.fixed = fixed_vertices(scene, filled.mesh.vertices);
  solid.mesh = std::move(filled.mesh);
  solid.material = scene.material;
  solid.density = scene.density.value();
  solid.mass_damping = simulation.mass_damping;
  solid.stiffness_damping = simulation.stiffness_damping;
  solid.time_step = simulation.time_step;
  solid.strain = simulation.corotational ? Strain::corotational : Strain::linear;
  solid.newmark = Newmark::dissipating(simulation.newmark_gamma);
  solid.shown = body.surface.positions;
  solid.triangles = flat(triangles_of_level(body.surface, body.surface.finest_level()));
  for (const auto& impulse : simulation.impulses) solid.velocities.push_back(impulse.velocity());
  solid.rest = simulation.rest;
  return solid;
}

SheetScene make_sheet_scene(const Scene& scene) {
  const Simulation& simulation = scene.simulation.value();
  SheetScene result;
  static_cast<Sheet&>(result) = simulation.sheet.value();
  result.mesh = read_surface(scene.mesh.path);
  Eigen::AlignedBox3d box;
  for (const auto& vertex : result.mesh.vertices) box.extend(vertex);
  const double scale = scene.mesh.scale(box);
  for (auto& vertex : result.mesh.vertices) vertex *= scale;
  result.fixed = fixed_vertices(scene, result.mesh.vertices);
  result.time_step = simulation.time_step;
  result.rest = simulation.rest;
  for (const auto& impulse : simulation.impulses) {
    result.impulses.push_back({impulse.velocity(), impulse.turning});
  }
  return result;
}

nlohmann::json simulate_scene(SimulateRequest request, ProgressBar& progress) {
  const Scene scene = read_scene(request.scene);
  if (!scene.simulation) {
    throw std::runtime_error(request.scene.string() + ": has no [simulate] section, which says what to play");
  }
  if (request.trajectories.empty()) request.trajectories = scene.simulation->trajectories;
  if (request.trajectories.empty()) {
    throw std::runtime_error(
        request.scene.string() +
        ": does not say where trajectories go; write [trajectories] file = \"NAME.h5\", or use -o");
  }
  auto [simulator, about, provenance] =
      scene.simulation->sheet ? make_sheets(scene, progress) : make_solid(scene, progress);

  const auto plan = plan_of(*scene.simulation);
  auto states = request.trajectories;
  states += ".states";
  const auto described = describe(*simulator, palette_of(*scene.simulation), successions(*scene.simulation),
                                  provenance_of(scene, std::move(provenance)));
  auto file = open_or_create(request, described, room_for(plan, simulator->time_step()), states);
  progress.begin("orbits");
  const auto replay_error = sample(*simulator, plan, file, states,
                                   [&](double fraction, std::string_view what) { progress.update(fraction, what); });
  auto record = record_of(file.scene(), std::move(about));
  if (replay_error) record["replay_estimate"] = *replay_error;
  record["file"] = request.trajectories.string();
  progress.end(fmt::format("{} orbits, {} frames", record["orbits"].dump(), record["frames"].dump()));
  file.close();
  return record;
}

}  // namespace greenloop::offline
