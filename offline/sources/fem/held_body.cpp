#include "offline/sources/fem/held_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "offline/sources/fem/refined_region.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t most_iterations = 400, recent = 10, refined_tetrahedra = 2000;
constexpr double settled_share = 0.02;

using Eigen::Index;
using Eigen::Matrix3Xd;

}  // namespace

HeldBody::HeldBody(const TetrahedralMesh& mesh, const MeshEdges& edges, const Material& material, Held held)
    : mesh_(mesh),
      edges_(edges),
      material_(material),
      held_(std::move(held)),
      free_(held_.vertices),
      stiffness_(mesh, edges, material) {
  if (free_.count > 0) factors_.emplace(assemble_stiffness(mesh, material, free_), 3);
  for (const auto& block : stiffness_.edge_blocks()) edge_block_.emplace_back(block);
}

Matrix3Xd HeldBody::relax_vertices(const Matrix3Xd& force) {
  Matrix3Xd moved = Matrix3Xd::Zero(3, force.cols());
  if (!factors_) return moved;
  Eigen::VectorXd of_free(Index{3} * free_.count);
  for (std::size_t v = 0; v < free_.number.size(); ++v) {
    if (free_.number[v] >= 0) of_free.segment<3>(Index{3} * free_.number[v]) = force.col(static_cast<Index>(v));
  }
  Eigen::MatrixXd solution;
  factors_->solve(of_free.sparseView(), solution);
  for (std::size_t v = 0; v < free_.number.size(); ++v) {
    if (free_.number[v] >= 0) {
      moved.col(static_cast<Index>(v)) = solution.col(0).segment<3>(Index{3} * free_.number[v]);
    }
  }
  return moved;
}

Matrix3Xd HeldBody::relax_edges(const Matrix3Xd& force) const {
  Matrix3Xd moved = Matrix3Xd::Zero(3, force.cols());
  for (Index e = 0; e < force.cols(); ++e) {
    if (held_.edges[e] == 0) moved.col(e) = edge_block_[e].solve(force.col(e));
  }
  return moved;
}

double HeldBody::balance_linear(QuadraticField& displacement) {
  displacement.vertex -= relax_vertices(stiffness_.force(displacement).vertex);
  return displacement.dot(stiffness_.force(displacement));
}

HeldBody::Descent HeldBody::descend(QuadraticField& displacement) {
  QuadraticField residual = stiffness_.force(displacement);
  const auto downhill = [&] { return QuadraticField{-relax_vertices(residual.vertex), -relax_edges(residual.edge)}; };
  QuadraticField direction = downhill();
  double product = -residual.dot(direction), recently = 0;
  Descent descent;
  // in every iteration twice the energy falls by what is exactly known
  std::vector<double> decrease;
  while (product > 0) {
    const QuadraticField force = stiffness_.force(direction);
    const double step = product / direction.dot(force);
    displacement.add(step, direction);
    residual.add(step, force);
    decrease.push_back(step * product);
    descent.released += decrease.back();
    recently += decrease.back() - (decrease.size() > recent ? decrease[decrease.size() - recent - 1] : 0);
    if (decrease.size() > recent && recently < settled_share * descent.released) break;
    if (decrease.size() >= most_iterations) {
      descent.settled = false;
      break;
    }
    const QuadraticField next = downhill();
    const double next_product = -residual.dot(next);
    direction.vertex = next.vertex + next_product / product * direction.vertex;
    direction.edge = next.edge + next_product / product * direction.edge;
    product = next_product;
  }
  return descent;
}

std::vector<int> tetrahedra_around(const TetrahedralMesh& mesh, std::span<const int> vertices) {
  std::vector<std::pair<double, int>> nearest;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const int v : mesh.tetrahedra[t]) center += 0.25 * mesh.vertices[v];
    double squared = std::numeric_limits<double>::max();
    for (const int v : vertices) squared = std::min(squared, (mesh.vertices[v] - center).squaredNorm());
    nearest.emplace_back(squared, static_cast<int>(t));
  }
  std::sort(nearest.begin(), nearest.end());
  nearest.resize(std::min(nearest.size(), refined_tetrahedra));
  std::vector<int> tetrahedra;
  tetrahedra.reserve(nearest.size());
  for (const auto& [squared, t] : nearest) tetrahedra.push_back(t);
  return tetrahedra;
}

HeldForces held_forces(HeldBody& body, QuadraticField displacement, std::span<const int> refined) {
  HeldForces forces;
  forces.linear = body.balance_linear(displacement);
  const HeldBody::Descent quadratic = body.descend(displacement);
  forces.quadratic = forces.linear - quadratic.released;
  RefinedRegion region = refine_region(body.mesh(), body.edges(), body.held(), displacement, refined);
  const HeldBody::Descent split =
      HeldBody(region.mesh, region.edges, body.material(), region.held).descend(region.displacement);
  forces.extrapolated = forces.quadratic * std::pow(1 - split.released / forces.quadratic, 2);
  forces.settled = quadratic.settled && split.settled;
  return forces;
}

}  // namespace greenloop::offline
