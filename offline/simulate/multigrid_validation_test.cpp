#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "offline/simulate/multigrid_model.hpp"
#include "offline/simulate/solid_dynamics.hpp"
#include "offline/simulate/testing/simulated_body.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double without_inertia = 1e4;  // s, a time step

Vec3 narrow(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vector3d wide(const Vec3& v) { return {v.x, v.y, v.z}; }

MultigridScene scene_of(TetrahedralMesh mesh, const Material& material, double density) {
  MultigridScene scene;
  scene.mesh = std::move(mesh);
  scene.fixed.assign(scene.mesh.vertices.size(), 0);
  scene.matter.kinds = {{material, density}};
  scene.matter.kind.assign(scene.mesh.tetrahedra.size(), 0);
  scene.time_step = without_inertia;
  scene.gravity.setZero();
  scene.numerical_damping = 1;  // what a step without inertia swings beyond is gone
  return scene;
}

/// Vertices of a scene in the order of its model.
std::vector<Vector3d> model_places(const MultigridScene& scene) {
  std::vector<Vector3d> places;
  for (const int held : {0, 1}) {
    for (std::size_t v = 0; v < scene.fixed.size(); ++v) {
      if (static_cast<int>(scene.fixed[v]) == held) places.push_back(scene.mesh.vertices[v]);
    }
  }
  return places;
}

/// Deflection of the end of the cantilever 10 x 1 x 1, E = 1000, nu = 0.3, under a unit shear spread over its end.
double cantilever_deflection(int cells) {
  MultigridScene scene = scene_of(testing::box({10 * cells, cells, cells}, {10, 1, 1}), {1000, 0.3}, 1e-9);
  scene.coarser = {testing::box({5 * cells, cells / 2, cells / 2}, {10, 1, 1}), testing::box({20, 2, 2}, {10, 1, 1})};
  if (cells == 4) scene.coarser.pop_back();
  scene.strain = layout::Strain::linear;
  for (std::size_t v = 0; v < scene.fixed.size(); ++v) scene.fixed[v] = scene.mesh.vertices[v].x() < 1e-9 ? 1 : 0;
  const std::vector<Vector3d> places = model_places(scene);
  const auto across = static_cast<std::uint32_t>((cells + 1) * (cells + 1));
  SimulatedBody body(scene, {.max_loads = across, .tolerance = 1e-6F});
  std::vector<Multigrid::Load> loads;
  double sum = 0;
  for (std::uint32_t v = 0; v < places.size(); ++v) {
    if (places[v].x() < 10 - 1e-9) continue;
    const auto share = [&](double t) { return t < 1e-9 || t > 1 - 1e-9 ? 0.5 : 1.0; };
    const double force = share(places[v].y()) * share(places[v].z()) / (cells * cells);
    loads.push_back({v, {0, 0, static_cast<float>(force)}});
  }
  for (int pass = 0; pass < 3; ++pass) REQUIRE(answered(body.step({.loads = loads}).status));
  for (const Multigrid::Load& load : loads) sum += double{load.force.z} * body.displacement()[load.vertex].z;
  return sum;
}

TEST_CASE("a cantilever of linear tetrahedra bends too little, by the square of the cell, towards the true one") {
  constexpr double truth = 4.004;  // of elements of order 5 and 6
  const double coarse = cantilever_deflection(4), fine = cantilever_deflection(8);
  const double order = std::log2((truth - coarse) / (truth - fine));
  const double beyond = fine + (fine - coarse) / 3;
  MESSAGE("deflection ", coarse, ", ", fine, " of ", truth, ", order ", order, "; by both ", beyond);
  CHECK(fine < truth);
  CHECK(order > 1.6);  // 2 but for the corners of the held end
  CHECK(beyond == doctest::Approx(truth).epsilon(0.02));
}

/// omega L / c_T of the lowest modes of a free unit cube, whose six rigid motions are left out.
std::vector<double> cube_frequencies(int cells, double poisson, int modes) {
  const TetrahedralMesh mesh = testing::box({cells, cells, cells}, {1, 1, 1});
  const FreeVertices free(std::vector<std::uint8_t>(mesh.vertices.size(), 0));
  const Material material{2 * (1 + poisson), poisson};  // shear modulus 1
  const Eigen::SparseMatrix<double> stiffness = assemble_stiffness(mesh, material, free);
  const Eigen::SparseMatrix<double> mass = assemble_mass(mesh, 1, free);
  Eigen::SparseMatrix<double> of_all(3 * free.count, 3 * free.count);
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < mass.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(mass, column); it; ++it) {
      for (int i = 0; i < 3; ++i) entries.emplace_back(3 * static_cast<int>(it.row()) + i, 3 * column + i, it.value());
    }
  }
  of_all.setFromTriplets(entries.begin(), entries.end());
  const auto times = [](const Eigen::SparseMatrix<double>& lower, const MatrixXd& x) {
    return MatrixXd(lower.selfadjointView<Eigen::Lower>() * x);
  };
  Factorization shifted(stiffness + of_all, 3);
  MatrixXd space = MatrixXd::Random(3 * free.count, 2 * (modes + 6));
  Eigen::VectorXd squares;
  for (int round = 0; round < 12; ++round) {
    space = times(of_all, space);
    shifted.solve(space);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> small(space.transpose() * times(stiffness, space),
                                                                   space.transpose() * times(of_all, space));
    space = space * small.eigenvectors();
    squares = small.eigenvalues();
  }
  std::vector<double> frequencies;
  for (int i = 0; i < modes; ++i) frequencies.push_back(std::sqrt(squares[6 + i]));
  return frequencies;
}

TEST_CASE("a free cube rings as it should, and higher by the square of the cell") {
  // of families whose members are alike; the second and the third change places as cells shrink
  constexpr double truth[] = {2.85608, (3.84599 + 3.91125) / 2};
  const std::vector<double> coarse = cube_frequencies(6, 0.3, 8), fine = cube_frequencies(12, 0.3, 8);
  const auto mean = [](const std::vector<double>& of, int from, int to) {
    return std::accumulate(of.begin() + from, of.begin() + to, 0.0) / (to - from);
  };
  const int ends[] = {0, 2, 8};
  for (int family = 0; family < 2; ++family) {
    const double above_coarse = mean(coarse, ends[family], ends[family + 1]) / truth[family] - 1;
    const double above = mean(fine, ends[family], ends[family + 1]) / truth[family] - 1;
    const double order = std::log2(above_coarse / above);
    MESSAGE("modes ", ends[family] + 1, " to ", ends[family + 1], ": above the true ", truth[family], " by ",
            100 * above_coarse, ", ", 100 * above, " %, order ", order);
    CHECK(above > 0);
    CHECK(above < 0.03);
    CHECK(order > 1.6);
  }
}

/// A cube of 2 x 2 x 2 cells of which the middle vertex alone is free: an oscillator, alike along x, y and z or not.
MultigridScene oscillator() {
  MultigridScene scene = scene_of(testing::box({2, 2, 2}, {2, 2, 2}), {1, 0}, 1);
  for (std::size_t v = 0; v < scene.fixed.size(); ++v) {
    scene.fixed[v] = (scene.mesh.vertices[v] - Vector3d(1, 1, 1)).norm() > 0.5 ? 1 : 0;
  }
  scene.strain = layout::Strain::linear;
  scene.numerical_damping = 0;
  return scene;
}

TEST_CASE("Newmark's method lengthens periods as theory says, and loses nothing") {
  MultigridScene scene = oscillator();
  const FreeVertices free(scene.fixed);
  const MatrixXd lower = assemble_stiffness(scene.mesh, scene.matter.kinds[0].material, free);
  const Matrix3d stiffness = lower.selfadjointView<Eigen::Lower>();
  const double mass = MatrixXd(assemble_mass(scene.mesh, 1, free))(0, 0);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> modes(stiffness);
  const Vector3d axis = modes.eigenvectors().col(2);
  const double omega = std::sqrt(modes.eigenvalues()[2] / mass);
  for (const double share : {0.01, 0.05, 0.1}) {  // of the period
    scene.time_step = share * 2 * std::numbers::pi / omega;
    SimulatedBody body(scene, {.tolerance = 1e-6F});
    const Multigrid::Load load{0, narrow(1e-2 * modes.eigenvalues()[2] * axis)};
    double last = 0, first = 0, crossed = 0, most = 0, late = 0;
    int crossings = 0;
    for (int i = 0; i < 60 / share; ++i) {  // about a load that stays
      REQUIRE(answered(body.step({.loads = {&load, 1}}).status));
      const double off = axis.dot(wide(body.displacement()[0])) - 1e-2;
      if (last < 0 && off >= 0) {
        crossed = i - off / (off - last);
        if (crossings++ == 0) first = crossed;
      }
      if (i * share < 10) most = std::max(most, off);
      if (i * share > 50) late = std::max(late, off);
      last = off;
    }
    const double period = (crossed - first) / (crossings - 1) * share;
    const double expected = std::numbers::pi * share / std::atan(std::numbers::pi * share);
    MESSAGE("steps of ", share, " periods: longer by ", 100 * (period - 1), " %, as theory ", 100 * (expected - 1),
            " %; amplitude after 50 periods ", late / most);
    CHECK(period - 1 == doctest::Approx(expected - 1).epsilon(0.01));
    CHECK(late / most == doctest::Approx(1).epsilon(2e-3));
  }
}

/// A box whose inner vertices do not lie on a grid, with every outer vertex to be held.
struct HeldBox {
  explicit HeldBox(layout::Strain strain) : scene(scene_of(testing::box({4, 3, 3}, {4, 3, 3}), {1e4, 0.3}, 1e-6)) {
    scene.strain = strain;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> drawn(-0.2, 0.2);
    for (Vector3d& x : scene.mesh.vertices) {
      if (!is_outer(x)) x += Vector3d(drawn(random), drawn(random), drawn(random));
    }
    scene.fixed[0] = 1;  // where it stays
    places = model_places(scene);
  }
  static bool is_outer(const Vector3d& x) {
    const Vector3d half(2, 1.5, 1.5);
    return ((x - half).cwiseAbs() - half).maxCoeff() > -1e-9;
  }
  /// Holds all of the outside where `deformation` puts it; the corner at the origin stays.
  [[nodiscard]] std::vector<Multigrid::Hold> holds(const Matrix3d& deformation) const {
    std::vector<Multigrid::Hold> held;
    for (std::uint32_t v = 0; v + 1 < places.size(); ++v) {
      if (is_outer(places[v])) held.push_back({v, narrow((deformation - Matrix3d::Identity()) * places[v])});
    }
    return held;
  }

  MultigridScene scene;
  std::vector<Vector3d> places;  // in the model's order
};

constexpr Multigrid::Limits all_held{.max_holds = 100, .tolerance = 1e-6F};

double farthest_off(const HeldBox& box, const SimulatedBody& body, const Matrix3d& deformation) {
  double most = 0;
  for (std::size_t v = 0; v < box.places.size(); ++v) {
    const Vector3d expected = (deformation - Matrix3d::Identity()) * box.places[v];
    most = std::max(most, (wide(body.displacement()[v]) - expected).norm());
  }
  return most;
}

TEST_CASE("patch test: what is held along an affine map follows it, with the forces of its law") {
  Matrix3d stretch;
  stretch << 0.3, 0.1, 0, 0, -0.2, 0.15, 0.05, 0, 0.1;
  const double young = 1e4, poisson = 0.3, mu = young / (2 * (1 + poisson)),
               lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  for (const layout::Strain strain : {layout::Strain::linear, layout::Strain::corotational, layout::Strain::green}) {
    const double size = strain == layout::Strain::linear ? 0.01 : 1;
    const Matrix3d f = Matrix3d::Identity() + size * stretch;
    const HeldBox box(strain);
    SimulatedBody body(box.scene, all_held);
    std::vector<Vec3> reaction;
    std::vector<Multigrid::Hold> held;
    for (int k = 1; k <= 10; ++k) {
      held = box.holds(Matrix3d::Identity() + 0.1 * k * size * stretch);
      reaction.resize(held.size());
      REQUIRE(answered(body.hold(held, reaction).status));
    }
    for (int k = 0; k < 5; ++k) REQUIRE(answered(body.hold(held, reaction).status));
    // the first Piola-Kirchhoff stress on the side x = 4 of 9 m^2
    const Matrix3d green = 0.5 * (f.transpose() * f - Matrix3d::Identity());
    const Eigen::JacobiSVD<Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
    const Matrix3d small = strain == layout::Strain::linear ? Matrix3d(0.5 * (f + f.transpose()) - Matrix3d::Identity())
                                                            : Matrix3d(turn.transpose() * f - Matrix3d::Identity());
    const auto law = [&](const Matrix3d& e) {
      return Matrix3d(2 * mu * e + lambda * e.trace() * Matrix3d::Identity());
    };
    const Matrix3d piola = strain == layout::Strain::green          ? Matrix3d(f * law(green))
                           : strain == layout::Strain::corotational ? Matrix3d(turn * law(small))
                                                                    : law(small);
    // moments of what holds the outside: the sum of r x^T is volume times the stress
    Matrix3d moments = Matrix3d::Zero();
    for (std::size_t i = 0; i < held.size(); ++i) {
      moments += wide(reaction[i]) * box.places[held[i].vertex].transpose();
    }
    const double off = farthest_off(box, body, f), wrong = (moments / 36 - piola).norm() / piola.norm();
    MESSAGE("strain ", static_cast<int>(strain), ": farthest from the map ", off / (4 * size),
            " of the motion, stress ", wrong);
    const double allowed = strain == layout::Strain::green ? 1e-4 : 2e-6;
    CHECK(off <= allowed * 4 * size);
    CHECK(wrong <= allowed);
  }
}

TEST_CASE("held all around and turned once, a body is as it was") {
  for (const layout::Strain strain : {layout::Strain::corotational, layout::Strain::green}) {
    const HeldBox box(strain);
    SimulatedBody body(box.scene, all_held);
    const Vector3d axis = Vector3d(1, 2, -3).normalized();
    std::vector<Vec3> reaction;
    double largest = 0;
    for (int k = 1; k <= 72; ++k) {
      const Matrix3d turn = Eigen::AngleAxisd(k * std::numbers::pi / 36, axis).toRotationMatrix();
      const std::vector<Multigrid::Hold> held = box.holds(turn);
      reaction.resize(held.size());
      REQUIRE(answered(body.hold(held, reaction).status));
      largest = std::max(largest, farthest_off(box, body, turn));
    }
    MESSAGE("strain ", static_cast<int>(strain), ": farthest off, of 4 m: on the way ", largest / 4, ", after a turn ",
            farthest_off(box, body, Matrix3d::Identity()) / 4);
    CHECK(farthest_off(box, body, Matrix3d::Identity()) <= 1e-6 * 4);
  }
}

}  // namespace
}  // namespace greenloop::offline
