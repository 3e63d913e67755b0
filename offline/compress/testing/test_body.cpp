#include "offline/compress/testing/test_body.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "formats/layout.hpp"
#include "offline/compress/wavelet/node_order.hpp"

namespace greenloop::offline::test {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

/// Splits every triangle at its edges' midpoints.
Triangles split(SemiRegularMesh& mesh, const Triangles& triangles) {
  std::map<std::pair<int, int>, int> midpoints;
  const auto midpoint = [&](int a, int b) {
    const std::pair<int, int> edge = std::minmax(a, b);
    const auto [it, added] = midpoints.try_emplace(edge, static_cast<int>(mesh.positions.size()));
    if (added) {
      const Eigen::Vector3d middle =
          0.5 * (mesh.positions[static_cast<std::size_t>(a)] + mesh.positions[static_cast<std::size_t>(b)]);
      mesh.positions.push_back(middle);
      mesh.parents.push_back({edge.first, edge.second});
    }
    return it->second;
  };
  Triangles finer;
  for (const auto& [a, b, c] : triangles) {
    const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return finer;
}

using Projection = Eigen::Vector3d (*)(const Eigen::Vector3d&);

Eigen::Vector3d stay(const Eigen::Vector3d& x) { return x; }

Eigen::Vector3d onto_sphere(const Eigen::Vector3d& x) { return x.normalized(); }

Eigen::Vector3d onto_torus(const Eigen::Vector3d& x) {
  const Eigen::Vector3d ring = Eigen::Vector3d(x.x(), x.y(), 0).normalized();
  return ring + torus_tube * (x - ring).normalized();
}

SemiRegularMesh refine(std::vector<Eigen::Vector3d> positions, const Triangles& base, int levels, Projection project) {
  SemiRegularMesh mesh;
  mesh.positions = std::move(positions);
  mesh.parents.assign(mesh.positions.size(), {-1, -1});
  mesh.base_triangles = base;
  mesh.vertex_end = {mesh.positions.size()};
  Triangles triangles = base;
  for (int level = 0; level < levels; ++level) {
    triangles = split(mesh, triangles);
    for (auto& position : mesh.positions) position = project(position);
    mesh.vertex_end.push_back(mesh.positions.size());
  }
  return mesh;
}

double blob_radius(const Eigen::Vector3d& direction) {
  const std::array<std::pair<Eigen::Vector3d, double>, 5> lobes = {{{{0.6, 0.0, 0.8}, 0.3},
                                                                    {{-0.6, 0.0, 0.8}, 0.3},
                                                                    {{0.8, 0.6, 0.0}, 0.4},
                                                                    {{-0.8, 0.6, 0.0}, 0.4},
                                                                    {{0.0, 0.6, -0.8}, 0.2}}};
  double radius = 0.6;
  for (const auto& [axis, height] : lobes) radius += height * std::exp(9.0 * (direction.dot(axis) - 1.0));
  return radius;
}

/// Displacement per force at distance `r`, regularised over the length `core`.
Eigen::Matrix3d regularised_kelvin(const Eigen::Vector3d& r, double core, double young, double poisson) {
  const double shear = young / (2.0 * (1.0 + poisson));
  const double a = 1.0 / (4.0 * std::numbers::pi * shear), b = a / (4.0 * (1.0 - poisson));
  const double e = std::sqrt(r.squaredNorm() + core * core);
  return ((a - b) / e + 0.5 * a * core * core / (e * e * e)) * Eigen::Matrix3d::Identity() +
         b / (e * e * e) * r * r.transpose();
}

Eigen::MatrixXd kelvin_matrix(const SemiRegularMesh& mesh, const std::vector<std::size_t>& to,
                              const std::vector<std::size_t>& from, double core) {
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(3 * to.size()), static_cast<Eigen::Index>(3 * from.size()));
  for (std::size_t i = 0; i < to.size(); ++i) {
    for (std::size_t j = 0; j < from.size(); ++j) {
      matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
          regularised_kelvin(mesh.positions[to[i]] - mesh.positions[from[j]], core, 1e5, 0.3);
    }
  }
  return matrix;
}

// between the nodes of the finest level (Pinkall & Polthier 1993)
Eigen::MatrixXd cotangent_laplacian(const SemiRegularMesh& mesh) {
  const auto count = static_cast<Eigen::Index>(mesh.positions.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  for (const auto& triangle : triangles_of_level(mesh, mesh.finest_level())) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int apex = triangle[k], a = triangle[(k + 1) % 3], b = triangle[(k + 2) % 3];
      const auto arm = [&](int node) -> Eigen::Vector3d {
        return mesh.positions[static_cast<std::size_t>(node)] - mesh.positions[static_cast<std::size_t>(apex)];
      };
      const double weight = 0.5 * arm(a).dot(arm(b)) / arm(a).cross(arm(b)).norm();
      matrix(a, a) += weight;
      matrix(b, b) += weight;
      matrix(a, b) -= weight;
      matrix(b, a) -= weight;
    }
  }
  return matrix;
}

std::vector<std::size_t> fixed_nodes(const Body& body) {
  std::vector<std::size_t> fixed;
  for (std::size_t node = 0; node < body.flags.size(); ++node) {
    if ((body.flags[node] & layout::node_fixed) != 0) fixed.push_back(node);
  }
  return fixed;
}

// without its compliance
Body held_blob(int levels) {
  const auto mesh = blob(levels);
  std::vector<std::uint32_t> flags;
  for (const auto& position : mesh.positions) {
    const bool fixed = position.normalized().y() < -0.6;
    flags.push_back(fixed ? layout::node_fixed : layout::node_touchable | layout::node_read);
  }
  flags = mark_domain(mesh, flags);
  auto ordered = order_nodes(mesh, flags);
  Body body;
  body.flags = ordered.reorder(flags);
  body.mesh = std::move(ordered.mesh);
  body.area = nodal_area(body.mesh);
  for (std::size_t node = 0; node < body.flags.size(); ++node) {
    if ((body.flags[node] & layout::node_fixed) == 0) body.column_nodes.push_back(node);
  }
  return body;
}

}  // namespace

SemiRegularMesh icosphere(int levels) {
  const double t = std::numbers::phi;
  std::vector<Eigen::Vector3d> positions = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                                            {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (auto& position : positions) position.normalize();
  const Triangles base = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return refine(std::move(positions), base, levels, onto_sphere);
}

SemiRegularMesh octasphere(int levels) {
  return refine({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}, levels,
                onto_sphere);
}

SemiRegularMesh torus(int levels) {
  constexpr int along = 10, around = 4;
  std::vector<Eigen::Vector3d> positions;
  Triangles base;
  for (int i = 0; i < along; ++i) {
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * i / along, Eigen::Vector3d::UnitZ());
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      positions.emplace_back(turn * Eigen::Vector3d(1 + torus_tube * std::cos(angle), 0, torus_tube * std::sin(angle)));
      const auto corner = [&](int di, int dk) { return (i + di) % along * around + (k + dk) % around; };
      base.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
      base.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  }
  return refine(std::move(positions), base, levels, onto_torus);
}

SemiRegularMesh blob(int levels) {
  auto mesh = icosphere(levels);
  for (auto& position : mesh.positions) position *= blob_radius(position);
  return mesh;
}

SemiRegularMesh square(int levels) {
  return refine({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, levels, stay);
}

std::vector<double> nodal_area(const SemiRegularMesh& mesh) {
  std::vector<double> area(mesh.positions.size(), 0.0);
  for (const auto& triangle : triangles_of_level(mesh, mesh.finest_level())) {
    const auto corner = [&](int k) {
      return mesh.positions[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    const double whole = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (const int node : triangle) area[static_cast<std::size_t>(node)] += whole / 3.0;
  }
  return area;
}

template <>
Body make_body<3>(int levels) {
  Body body = held_blob(levels);
  const auto fixed = fixed_nodes(body);
  double total = 0;
  for (const double area : body.area) total += area;
  const double core = 0.5 * std::sqrt(total / static_cast<double>(body.area.size()));
  const auto free_fixed = kelvin_matrix(body.mesh, body.column_nodes, fixed, core);
  const Eigen::LLT<Eigen::MatrixXd> support(kelvin_matrix(body.mesh, fixed, fixed, core));
  body.compliance = kelvin_matrix(body.mesh, body.column_nodes, body.column_nodes, core) -
                    free_fixed * support.solve(free_fixed.transpose());
  return body;
}

template <>
Body make_body<1>(int levels) {
  Body body = held_blob(levels);
  Eigen::MatrixXd conductance = cotangent_laplacian(body.mesh);
  for (std::size_t node = 0; node < body.area.size(); ++node) {
    const auto at = static_cast<Eigen::Index>(node);
    conductance(at, at) += body.area[node] / (screening_length * screening_length);
  }
  const Eigen::MatrixXd free = conductance(body.column_nodes, body.column_nodes);
  const Eigen::MatrixXd inverse = free.llt().solve(Eigen::MatrixXd::Identity(free.rows(), free.cols()));
  body.compliance = 0.5 * (inverse + inverse.transpose());
  return body;
}

}  // namespace greenloop::offline::test
