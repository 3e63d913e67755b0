#include "offline/pipeline/mesh_series_file.hpp"

#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"
#include "formats/trajectory/trajectory_file.hpp"

namespace greenloop::offline {
namespace {

std::vector<float> positions_in_metres(const TriangleMesh& mesh, double unit) {
  std::vector<float> positions;
  positions.reserve(3 * mesh.vertices.size());
  for (const Eigen::Vector3d& x : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(unit * x[axis]));
  }
  return positions;
}

TrajectoryScene scene_of(const MeshSeries& series, const TriangleMesh& rest) {
  TrajectoryScene scene;
  scene.time_step = series.time_step;
  scene.rest = positions_in_metres(rest, series.unit);
  for (const auto& triangle : rest.triangles) {
    for (const int vertex : triangle) scene.triangles.push_back(static_cast<std::uint32_t>(vertex));
  }
  scene.impulses = series.impulses;
  scene.successions = series.successions;
  scene.provenance = R"({"source": "mesh series"})";
  return scene;
}

std::uint64_t frames_of(const MeshSeries& series) {
  return std::accumulate(series.orbits.begin(), series.orbits.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const OrbitSeries& orbit) { return sum + orbit.count; });
}

void write_orbit(const OrbitSeries& orbit, const MeshSeries& series, const TriangleMesh& rest, TrajectoryWriter& writer,
                 MeshNotes& notes) {
  std::int64_t previous = -1;
  if (orbit.previous) {
    const auto [before, frame] = *orbit.previous;
    previous = static_cast<std::int64_t>(writer.scene().orbits[before].first_frame + frame);
  }
  writer.begin_orbit(orbit.impulse, previous, orbit.held_out);
  for (std::uint64_t k = 0; k < orbit.count; ++k) {
    const TriangleMesh mesh = read_surface(orbit.file(k), notes);
    if (mesh.vertices.size() != rest.vertices.size() || mesh.triangles != rest.triangles) {
      throw std::runtime_error(orbit.file(k).string() + ": has other triangles or another number of vertices than " +
                               series.rest.string());
    }
    writer.add_frame(positions_in_metres(mesh, series.unit));
  }
  writer.end_orbit(orbit.at_rest);
}

}  // namespace

void write_mesh_series(const MeshSeries& series, const std::filesystem::path& output, MeshNotes& notes) {
  const TriangleMesh rest = read_surface(series.rest, notes);
  auto writer = TrajectoryWriter::create(output, scene_of(series, rest),
                                         {.frames = frames_of(series), .orbits = series.orbits.size()});
  for (const OrbitSeries& orbit : series.orbits) write_orbit(orbit, series, rest, writer, notes);
  writer.close();
}

}  // namespace greenloop::offline
