#include "offline/sources/fem/green_functions.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include "formats/layout.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/fem_source.hpp"
#include "offline/sources/fem/rigid_motion.hpp"
#include "offline/sources/reciprocity.hpp"
#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/lumped_areas.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

class TemporaryStore {
 public:
  explicit TemporaryStore(const char* name)
      : path(std::filesystem::temp_directory_path() / ("greenloop-" + std::to_string(getpid()) + "-" + name)) {}
  ~TemporaryStore() { std::filesystem::remove(path); }
  TemporaryStore(const TemporaryStore&) = delete;
  TemporaryStore& operator=(const TemporaryStore&) = delete;
  const std::filesystem::path path;
};

/// An ellipsoid held at its lower end; columns at its upper half, rows at all nodes that move.
GreenStoreContents ellipsoid_problem(int levels) {
  GreenStoreContents contents;
  contents.surface = testing::ellipsoid(levels, {0.1, 0.08, 0.12});
  const auto surface = finest_surface(contents.surface);
  contents.area = lumped_areas(surface);
  contents.volume = tetrahedralize(surface).mesh;
  contents.volume_fixed.assign(contents.volume.vertices.size(), 0);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const double z = surface.vertices[v].z();
    contents.volume_fixed[v] = z < -0.08 ? 1 : 0;
    contents.flags.push_back(z < -0.08 ? layout::node_fixed : layout::node_domain);
    if (z >= -0.08) contents.row_node.push_back(static_cast<int>(v));
    if (z > 0.0) contents.column_node.push_back(static_cast<int>(v));
  }
  contents.interpolation = select_first_vertices(static_cast<int>(surface.vertices.size()),
                                                 static_cast<int>(contents.volume.vertices.size()));
  contents.young = 1e5;
  contents.poisson = 0.4;
  contents.fingerprint = "00";
  return contents;
}

/// B K^-1 B^T with a dense factorisation.
MatrixXd dense_compliance(const GreenStoreContents& contents) {
  const FreeVertices free(contents.volume_fixed);
  const auto lower = assemble_stiffness(contents.volume, {contents.young, contents.poisson}, free);
  const MatrixXd stiffness = MatrixXd(lower).selfadjointView<Eigen::Lower>();
  const auto interpolate = [&](const std::vector<int>& nodes) {
    MatrixXd weights = MatrixXd::Zero(3 * static_cast<Eigen::Index>(nodes.size()), Eigen::Index{3} * free.count);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      for (Interpolation::InnerIterator it(contents.interpolation, nodes[k]); it; ++it) {
        if (free.number[it.col()] < 0) continue;
        weights.block<3, 3>(3 * static_cast<Eigen::Index>(k), Eigen::Index{3} * free.number[it.col()]) =
            it.value() * Eigen::Matrix3d::Identity();
      }
    }
    return weights;
  };
  return interpolate(contents.row_node) * stiffness.llt().solve(interpolate(contents.column_node).transpose());
}

TEST_CASE("the columns are those of the dense inverse, and reciprocal") {
  const TemporaryStore file("dense.h5");
  const auto contents = ellipsoid_problem(2);
  auto store = GreenStore::create(file.path, contents);
  double last_fraction = 0.0;
  const auto report = solve_green_functions(store, [&](const FillProgress& progress) {
    CHECK(progress.fraction > last_fraction);
    CHECK(progress.seconds_remaining >= 0.0);
    last_fraction = progress.fraction;
  });
  CHECK(last_fraction == 1.0);
  CHECK(report.columns_solved == store.column_count());
  CHECK(report.largest_asymmetry < 1e-12);
  CHECK(report.largest_asymmetry > 0.0);
  const MatrixXd expected = dense_compliance(contents);
  CHECK((store.read_columns(0, store.column_count()) - expected).norm() < 1e-11 * expected.norm());
}

TEST_CASE("a pattern of forces does what its unit forces do together") {
  const auto contents = ellipsoid_problem(1);
  FemSource solver(fem_problem(contents));
  const std::vector<int> nodes(contents.column_node.begin(), contents.column_node.begin() + 3);
  const auto units = unit_patterns(contents.interpolation.rows(), nodes);
  const MatrixXd single = solver.displacement(units);
  REQUIRE(single.cols() == 9);
  const Eigen::SparseMatrix<double> pattern =
      units * Eigen::SparseMatrix<double>(Vector3d(2.0, -1.0, 0.5).sparseView());
  const MatrixXd expected = 2.0 * single.leftCols(3) - single.middleCols(3, 3) + 0.5 * single.rightCols(3);
  CHECK((solver.displacement(pattern) - expected).norm() < 1e-12 * expected.norm());
}

TEST_CASE("an interrupted run solves only what is missing, with the same result") {
  const TemporaryStore whole_file("whole.h5"), resumed_file("resumed.h5");
  const auto contents = ellipsoid_problem(2);
  auto whole = GreenStore::create(whole_file.path, contents);
  (void)solve_green_functions(whole);
  const int total = whole.column_count(), done = 11;
  {
    auto partial = GreenStore::create(resumed_file.path, contents);
    partial.write_columns(5, whole.read_columns(5, done));
  }
  auto resumed = GreenStore::open(resumed_file.path, GreenStore::Access::kReadWrite);
  CHECK(solve_green_functions(resumed).columns_solved == total - done);
  const MatrixXd expected = whole.read_columns(0, total);
  CHECK((resumed.read_columns(0, total) - expected).norm() < 1e-12 * expected.norm());
  CHECK(solve_green_functions(resumed).columns_solved == 0);
}

TEST_CASE("the body force is solved beside the columns, or by itself where it is missing, to the same bits") {
  const TemporaryStore file("body_force.h5"), other("body_force_later.h5"), third("no_volume.h5");
  const auto contents = ellipsoid_problem(1);
  auto store = GreenStore::create(file.path, contents);
  (void)solve_green_functions(store);
  REQUIRE(store.is_body_force_done());
  const MatrixXd moved = store.read_body_force();
  CHECK(moved.norm() > 0);
  CHECK(body_force_displacement(store) == moved);
  auto later = GreenStore::create(other.path, contents);
  CHECK(body_force_displacement(later) == moved);
  CHECK(later.is_body_force_done());
  auto without = contents;
  without.volume = {};
  without.volume_fixed.clear();
  auto measured = GreenStore::create(third.path, without);
  CHECK_THROWS_WITH_AS((void)body_force_displacement(measured), doctest::Contains("no volume"), std::runtime_error);
}

TEST_CASE("reciprocity that does not hold is measured and refused") {
  const TemporaryStore file("asymmetric.h5");
  auto store = GreenStore::create(file.path, ellipsoid_problem(1));
  (void)solve_green_functions(store);
  MatrixXd column = store.read_columns(2, 1);
  column *= 1.0 + 1e-6;
  store.write_columns(2, column);
  CHECK(largest_asymmetry(store) > 1e-8);
  CHECK_THROWS_WITH_AS((void)solve_green_functions(store), doctest::Contains("reciprocity"), std::runtime_error);
}

TEST_CASE("a body that can move rigidly is refused before it is solved") {
  const TemporaryStore file("loose.h5");
  auto contents = ellipsoid_problem(1);
  std::fill(contents.volume_fixed.begin(), contents.volume_fixed.end(), 0);
  contents.volume_fixed[3] = contents.volume_fixed[4] = 1;
  auto store = GreenStore::create(file.path, contents);
  CHECK_THROWS_WITH_AS((void)solve_green_functions(store), doctest::Contains("move rigidly"), std::runtime_error);
}

/// A box of tetrahedra and surface nodes between its boundary vertices, on the face z = 1.
GreenStoreContents user_mesh_problem() {
  GreenStoreContents contents;
  contents.volume = testing::box({6, 6, 6}, {1, 1, 1});
  for (const auto& x : contents.volume.vertices) contents.volume_fixed.push_back(x.z() == 0.0 ? 1 : 0);
  auto& surface = contents.surface;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) surface.positions.emplace_back(0.11 + 0.25 * i, 0.07 + 0.26 * j, 1.0);
  }
  surface.vertex_end = {16};
  surface.parents.assign(16, {-1, -1});
  contents.area.assign(16, 0.06);
  contents.flags.assign(16, layout::node_domain | layout::node_touchable | layout::node_read);
  for (int v = 0; v < 16; ++v) contents.row_node.push_back(v);
  contents.column_node = contents.row_node;
  contents.interpolation = interpolate_on_boundary(surface.positions, contents.volume, 1e-9);
  contents.young = 1.0;
  contents.poisson = 0.3;
  return contents;
}

TEST_CASE("surface nodes on a given tetrahedral mesh: the compliance is B K^-1 B^T and positive definite") {
  const TemporaryStore file("user.h5");
  const auto contents = user_mesh_problem();
  auto store = GreenStore::create(file.path, contents);
  CHECK(solve_green_functions(store).largest_asymmetry < 1e-12);
  const MatrixXd compliance = store.read_columns(0, 16), expected = dense_compliance(contents);
  CHECK((compliance - expected).norm() < 1e-11 * expected.norm());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> spectrum(compliance);
  CHECK(spectrum.eigenvalues()[0] > 1e-4 * spectrum.eigenvalues()[47]);
}

TEST_CASE("interpolation reproduces positions and its transpose keeps the resultant") {
  const auto contents = user_mesh_problem();
  const auto boundary = extract_boundary(contents.volume);
  CHECK(boundary.surface.vertices.size() == 7 * 7 * 7 - 5 * 5 * 5);
  CHECK(enclosed_volume(boundary.surface) == doctest::Approx(1.0));
  for (int n = 0; n < 16; ++n) {
    Vector3d sum = Vector3d::Zero();
    double weights = 0.0;
    for (Interpolation::InnerIterator it(contents.interpolation, n); it; ++it) {
      sum += it.value() * contents.volume.vertices[it.col()];
      weights += it.value();
    }
    CHECK((sum - contents.surface.positions[n]).norm() < 1e-14);
    CHECK(weights == doctest::Approx(1.0).epsilon(1e-14));
  }
  CHECK_THROWS_WITH_AS((void)interpolate_on_boundary({Vector3d(0.5, 0.5, 1.2)}, contents.volume, 1e-3),
                       doctest::Contains("same unit"), std::runtime_error);
}

TEST_CASE("surface nodes that a tetrahedral mesh cannot tell apart are refused") {
  const auto volume = testing::box({2, 1, 1}, {2, 1, 1});
  std::vector<std::uint8_t> fixed;
  for (const auto& x : volume.vertices) fixed.push_back(x.z() == 0.0 ? 1 : 0);
  const auto check = [&](const std::vector<Vector3d>& nodes, const char* reason) {
    const auto weights = interpolate_on_boundary(nodes, volume, 1e-9);
    std::vector<int> all(nodes.size());
    std::iota(all.begin(), all.end(), 0);
    CHECK_THROWS_WITH_AS(require_independent(weights, all, fixed), doctest::Contains(reason), std::runtime_error);
  };
  check({{0.1, 0.2, 1}, {0.3, 0.1, 1}, {0.8, 0.3, 1}, {0.6, 0.9, 1}, {0.5, 0.2, 1}}, "fewer levels");
  check({{0.1, 0.2, 0}}, "cannot move");
  check({{0.0, 0.0, 1}, {1.0, 1.0, 1}, {0.5, 0.5, 1}, {1.6, 0.3, 1}}, "moves exactly");
}

TEST_CASE("support is asked of every piece") {
  auto mesh = testing::box({1, 1, 1}, {1, 1, 1});
  const auto other = mesh;
  for (const auto& x : other.vertices) mesh.vertices.emplace_back(x + Vector3d(3, 0, 0));
  for (const auto& t : other.tetrahedra) mesh.tetrahedra.push_back({t[0] + 8, t[1] + 8, t[2] + 8, t[3] + 8});
  std::vector<std::uint8_t> fixed(16, 0);
  for (const int v : {0, 1, 2, 8, 9, 10}) fixed[v] = 1;
  CHECK_NOTHROW(require_no_rigid_motion(mesh, fixed));
  fixed[10] = 0;
  CHECK_THROWS_AS(require_no_rigid_motion(mesh, fixed), std::runtime_error);
}

}  // namespace
}  // namespace greenloop::offline
