// Times the path from a closed surface to a store of Green's functions: greenloop-solve-bench FILE.off, or a number of
// levels for a split icosahedron; then optionally the growth of the interior elements and the store to write.
#include <sys/resource.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "formats/layout.hpp"
#include "formats/mesh/surface_io.hpp"
#include "formats/store/green_store.hpp"
#include "offline/remesh/remesh.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/green_functions.hpp"
#include "offline/surface/lumped_areas.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace {

using namespace greenloop;
using namespace greenloop::offline;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

SemiRegularMesh surface_of(const std::string& source, int levels) {
  if (source.find('.') == std::string::npos) return testing::ellipsoid(std::atoi(source.c_str()), {0.1, 0.09, 0.08});
  RemeshOptions options;
  options.levels = levels;
  return remesh(read_surface(source), options).mesh;
}

/// The lowest part of the body is fixed so that about 84 % of the nodes are free, each a column and a row.
GreenStoreContents problem_on(const SemiRegularMesh& surface, const TetrahedralMesh& volume, const TriangleMesh& fine) {
  GreenStoreContents contents;
  contents.surface = surface;
  contents.area = lumped_areas(fine);
  contents.volume = volume;
  contents.volume_fixed.assign(volume.vertices.size(), 0);
  Eigen::AlignedBox3d box;
  for (const auto& x : fine.vertices) box.extend(x);
  const double bound = box.min().z() + 0.16 * box.sizes().z();
  for (std::size_t v = 0; v < fine.vertices.size(); ++v) {
    const bool fixed = fine.vertices[v].z() < bound;
    contents.volume_fixed[v] = fixed ? 1 : 0;
    contents.flags.push_back(fixed ? layout::node_fixed
                                   : layout::node_domain | layout::node_touchable | layout::node_read);
    if (!fixed) contents.row_node.push_back(static_cast<int>(v));
  }
  contents.column_node = contents.row_node;
  contents.interpolation =
      select_first_vertices(static_cast<int>(fine.vertices.size()), static_cast<int>(volume.vertices.size()));
  contents.young = 1e5;
  contents.poisson = 0.4;
  return contents;
}

void run(const std::string& source, int levels, double growth, const std::string& path) {
  const auto surface = surface_of(source, levels);
  const auto fine = finest_surface(surface);
  double before = cpu_seconds();
  const auto filled = tetrahedralize(fine, {.interior_growth = growth});
  std::printf(
      "surface %zu vertices; %s: %zu interior nodes, %zu tetrahedra, min quality %.3f, %zu slivers, %.1f s CPU\n",
      fine.vertices.size(), filled.mesher.c_str(), filled.quality.interior_nodes, filled.mesh.tetrahedra.size(),
      filled.quality.min_quality, filled.quality.slivers, cpu_seconds() - before);
  before = cpu_seconds();
  auto store = GreenStore::create(path, problem_on(surface, filled.mesh, fine));
  const auto report = solve_green_functions(store, [](const FillProgress& progress) {
    std::fprintf(stderr, "\r%3.0f %%, %.0f s left ", 100.0 * progress.fraction, progress.seconds_remaining);
  });
  std::printf(
      "\n%d column nodes, %lld unknowns, %.3g factor entries: factor %.2f s, columns %.2f s wall (%.1f s CPU in all), "
      "asymmetry %.1e, store %.0f MB\n",
      report.columns_solved, static_cast<long long>(report.unknowns), static_cast<double>(report.factor_entries),
      report.factor_seconds, report.solve_seconds, cpu_seconds() - before, report.largest_asymmetry,
      1e-6 * static_cast<double>(std::filesystem::file_size(path)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: greenloop-solve-bench SPHERE_LEVELS|SURFACE_FILE [LEVELS [GROWTH [STORE]]]\n");
    return 2;
  }
  const int levels = argc > 2 ? std::atoi(argv[2]) : 3;
  const double growth = argc > 3 ? std::atof(argv[3]) : TetrahedralizeOptions{}.interior_growth;
  try {
    run(argv[1], levels, growth, argc > 4 ? argv[4] : "solve-bench.h5");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "greenloop-solve-bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
