#include "rt_tests/gel_pad/refined_pad.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>

#include "offline/sources/fem/factorization.hpp"
#include "offline/sources/fem/quadratic_elements.hpp"

namespace greenloop::gel_pad {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// what one place feels of a tool
struct Gap {
  double distance;
  Vector3d normal;
};

Gap gap_at(const Shape& shape, const Placement& placement, const Vector3d& place) {
  const SignedDistance found = shape.distance(placement.to_tool({place.x(), place.y(), place.z()}));
  const Double3 normal = placement.turned(found.normal);
  return {found.distance, {normal.x, normal.y, normal.z}};
}

// forces f >= 0 with gap + W f >= 0, one of both zero: sweeps, each place exactly
Eigen::VectorXd solve_signorini(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap, Eigen::VectorXd force) {
  constexpr int most_sweeps = 20000;
  constexpr double settled = 1e-9;  // of the largest force
  Eigen::VectorXd moved = compliance * force;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0;
    for (Index i = 0; i < gap.size(); ++i) {
      const double next = std::max(0.0, force[i] - (gap[i] + moved[i]) / compliance(i, i));
      const double step = next - force[i];
      if (step == 0) continue;
      moved += step * compliance.col(i);
      force[i] = next;
      change = std::max(change, std::abs(step));
    }
    if (change <= settled * force.maxCoeff()) return force;
  }
  throw std::runtime_error("the contact of the refined pad did not settle");
}

using offline::FreePoints;
using offline::MeshEdges;
using offline::testing::Planes;

// vertices and edges that are not bonded, numbered
FreePoints points_above(const TetrahedralMesh& mesh, const MeshEdges& edges, double bottom) {
  FreePoints free;
  const auto is_bonded = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].z() <= bottom; };
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    free.vertex.push_back(is_bonded(v) ? -1 : free.count++);
  }
  for (const auto& [a, b] : edges.ends) free.edge.push_back(is_bonded(a) && is_bonded(b) ? -1 : free.count++);
  return free;
}

// with springs that hold what lies on a quarter's symmetry planes
void hold_mirrors(const TetrahedralMesh& mesh, const MeshEdges& edges, const FreePoints& free,
                  Eigen::SparseMatrix<double>& stiffness) {
  constexpr double rigid = 1e8;  // times the point's own stiffness
  const auto hold = [&](int point, const Vector3d& a, const Vector3d& b) {
    for (int axis = 0; axis < 2 && point >= 0; ++axis) {
      if (a[axis] == 0 && b[axis] == 0) stiffness.coeffRef(3 * point + axis, 3 * point + axis) *= rigid;
    }
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) hold(free.vertex[v], mesh.vertices[v], mesh.vertices[v]);
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    hold(free.edge[e], mesh.vertices[static_cast<std::size_t>(a)], mesh.vertices[static_cast<std::size_t>(b)]);
  }
}

// Column v: the mean displacement of the upper side, weighted by vertex v's linear function, from those of the points.
Eigen::SparseMatrix<double> upper_means(const TetrahedralMesh& mesh, const MeshEdges& edges, const FreePoints& free,
                                        double top) {
  constexpr int sides[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> weight(mesh.vertices.size(), 0.0);
  for (const auto& tetrahedron : mesh.tetrahedra) {
    for (const auto& side : sides) {
      const int node[3] = {tetrahedron[side[0]], tetrahedron[side[1]], tetrahedron[side[2]]};
      const Vector3d &a = mesh.vertices[node[0]], &b = mesh.vertices[node[1]], &c = mesh.vertices[node[2]];
      if (std::min({a.z(), b.z(), c.z()}) < top) continue;
      const double area = (b - a).cross(c - a).norm() / 2;
      for (int i = 0; i < 3; ++i) {
        // the integral of 4 L_j L_k L_i is 2/15 of the area if i is one of j and k, else 1/15
        const int v = node[i], next = node[(i + 1) % 3], after = node[(i + 2) % 3];
        entries.emplace_back(free.edge[edges.between(v, next)], v, 2 * area / 15);
        entries.emplace_back(free.edge[edges.between(v, after)], v, 2 * area / 15);
        entries.emplace_back(free.edge[edges.between(next, after)], v, area / 15);
        weight[v] += area / 3;
      }
    }
  }
  for (auto& entry : entries) entry = {entry.row(), entry.col(), entry.value() / weight[entry.col()]};
  for (std::size_t v = 0; v < weight.size(); ++v) {
    if (weight[v] > 0) entries.emplace_back(free.vertex[v], static_cast<int>(v), 1.0);
  }
  Eigen::SparseMatrix<double> means(free.count, static_cast<Index>(mesh.vertices.size()));
  means.setFromTriplets(entries.begin(), entries.end());
  return means;
}

}  // namespace

RefinedPad::RefinedPad(const Planes& planes, const Material& material, double reach)
    : is_quarter_(planes[0].front() == 0) {
  const TetrahedralMesh mesh = offline::testing::box(planes);
  const MeshEdges edges = offline::list_edges(mesh);
  const FreePoints free = points_above(mesh, edges, planes[2].front());
  const Eigen::SparseMatrix<double> read = upper_means(mesh, edges, free, planes[2].back());
  const Eigen::VectorXd areas =
      crossing_areas({planes[0], planes[1]});  // of the upper side's vertices, which come last
  const std::size_t lower = mesh.vertices.size() - static_cast<std::size_t>(areas.size());
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::copy_if(planes[axis].begin(), planes[axis].end(), std::back_inserter(planes_[axis]),
                 [=](double x) { return std::abs(x) <= reach; });
  }
  std::vector<Eigen::Triplet<double>> entries;  // of forces along each axis at each place
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3d& x = mesh.vertices[v];
    if (x.z() < planes[2].back() || x.head<2>().cwiseAbs().maxCoeff() > reach) continue;
    const auto place = static_cast<int>(places_.size());
    places_.push_back(x);
    area_.push_back(areas[static_cast<Index>(v - lower)]);
    for (Eigen::SparseMatrix<double>::InnerIterator it(read, static_cast<Index>(v)); it; ++it) {
      for (int axis = 0; axis < 3; ++axis) entries.emplace_back(3 * it.row() + axis, 3 * place + axis, it.value());
    }
  }
  const auto size = 3 * static_cast<Index>(places_.size());
  Eigen::SparseMatrix<double> forces(Index{3} * free.count, size);
  forces.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> stiffness = offline::assemble_stiffness(mesh, edges, material, free);
  if (is_quarter_) hold_mirrors(mesh, edges, free, stiffness);
  offline::Factorization factors(stiffness, 3);
  compliance_.resize(size, size);
  constexpr Index at_once = 192;
  for (Index first = 0; first < size; first += at_once) {
    const Index count = std::min(at_once, size - first);
    Eigen::MatrixXd moved;
    factors.solve(forces.middleCols(first, count), moved);
    compliance_.middleCols(first, count) = forces.transpose() * moved;
  }
}

Pressed RefinedPad::press(const Shape& shape, const Pose& pose) const {
  constexpr int most_rounds = 100;
  constexpr double settled = 1e-9;  // m
  const Placement placement = place(pose).placement;
  const auto count = static_cast<Index>(places_.size());
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(3 * count), force = Eigen::VectorXd::Zero(count);
  for (int round = 0; round < most_rounds; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * count, count);
    Eigen::VectorXd gap(count);
    for (Index i = 0; i < count; ++i) {
      const Gap here = gap_at(shape, placement, places_[static_cast<std::size_t>(i)] + moved.segment<3>(3 * i));
      normal.col(i).segment<3>(3 * i) = here.normal;
      gap[i] = here.distance - here.normal.dot(moved.segment<3>(3 * i));
    }
    Eigen::MatrixXd columns(3 * count, count);  // what normal forces move
    for (Index i = 0; i < count; ++i) {
      columns.col(i) = compliance_.middleCols<3>(3 * i) * normal.col(i).segment<3>(3 * i);
    }
    Eigen::MatrixXd between(count, count);
    for (Index i = 0; i < count; ++i) {
      between.row(i) = normal.col(i).segment<3>(3 * i).transpose() * columns.middleRows<3>(3 * i);
    }
    force = solve_signorini(between, gap, force);
    const Eigen::VectorXd next = columns * force;
    const double change = (next - moved).cwiseAbs().maxCoeff();
    moved = next;
    if (change > settled) continue;
    Pressed pressed{0, {planes_, Eigen::VectorXd(count), is_quarter_}};
    for (Index i = 0; i < count; ++i) {
      const double pushed = -force[i] * normal(3 * i + 2, i);
      pressed.force += is_quarter_ ? 4 * pushed : pushed;
      pressed.pressure.value[i] = pushed / area_[static_cast<std::size_t>(i)];
    }
    return pressed;
  }
  throw std::runtime_error("the tool on the refined pad did not settle");
}

Planes quarter(const Planes& planes) {
  Planes part = planes;
  for (int axis = 0; axis < 2; ++axis) {
    part[axis].erase(part[axis].begin(), std::find(part[axis].begin(), part[axis].end(), 0.0));
  }
  return part;
}

}  // namespace greenloop::gel_pad
