#include "offline/simulate/solid_elements.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

Eigen::Matrix3d edges_of(const TetrahedralMesh& mesh, const std::array<int, 4>& tetrahedron) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = mesh.vertices[tetrahedron[a + 1]] - mesh.vertices[tetrahedron[0]];
  return edges;
}

Eigen::Matrix3d rotation_by_singular_values(const Eigen::Matrix3d& deformation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& deformation) {
  constexpr double smallest_determinant = 1e-3;
  constexpr int most_iterations = 20;
  constexpr double converged = 1e-26;  // of the last change, squared; each iteration squares it
  if (!(deformation.determinant() > smallest_determinant)) return rotation_by_singular_values(deformation);
  Eigen::Matrix3d rotation = deformation;
  for (int i = 0; i < most_iterations; ++i) {
    const Eigen::Matrix3d next = 0.5 * (rotation + rotation.inverse().transpose());
    const double change = (next - rotation).squaredNorm();
    rotation = next;
    if (change < converged) break;
  }
  return rotation;
}

SolidElements::SolidElements(const TetrahedralMesh& mesh, const Material& material, const FreeVertices& free)
    : lame_(material), free_count_(free.count) {
  elements_.reserve(mesh.tetrahedra.size());
  for (const auto& tetrahedron : mesh.tetrahedra) {
    const Eigen::Matrix3d edges = edges_of(mesh, tetrahedron);
    Element element{{}, {}, edges.determinant() / 6};
    if (!(element.volume > 0)) {
      throw std::invalid_argument("tetrahedron " + std::to_string(elements_.size()) + " has no positive volume");
    }
    element.gradient.rightCols<3>() = edges.inverse().transpose();
    element.gradient.col(0) = -element.gradient.rightCols<3>().rowwise().sum();
    for (int a = 0; a < 4; ++a) element.free[a] = free.number[tetrahedron[a]];
    elements_.push_back(element);
  }
}

Eigen::Matrix3d SolidElements::gradient_of(const Element& element, const Eigen::VectorXd& vector) const {
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 4; ++a) {
    if (element.free[a] < 0) continue;
    gradient += vector.segment<3>(Eigen::Index{3} * element.free[a]) * element.gradient.col(a).transpose();
  }
  return gradient;
}

Eigen::Matrix3d SolidElements::stress(const Eigen::Matrix3d& strain) const {
  Eigen::Matrix3d result = lame_.mu * (strain + strain.transpose());
  result.diagonal().array() += lame_.lambda * strain.trace();
  return result;
}

void SolidElements::spread(const Element& element, const Eigen::Matrix3d& piola, Eigen::VectorXd& force) const {
  for (int a = 0; a < 4; ++a) {
    if (element.free[a] < 0) continue;
    force.segment<3>(Eigen::Index{3} * element.free[a]) += element.volume * (piola * element.gradient.col(a));
  }
}

SolidElements::Rotations SolidElements::rotations(const Eigen::VectorXd& displacement) const {
  Rotations result;
  result.reserve(elements_.size());
  for (const Element& element : elements_) {
    result.push_back(rotation_of(Eigen::Matrix3d::Identity() + gradient_of(element, displacement)));
  }
  return result;
}

SolidElements::Rotations SolidElements::vertex_rotations(const Rotations& rotations) const {
  Rotations result(free_count_, Eigen::Matrix3d::Zero());
  std::vector<double> volume(free_count_, 0);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    for (const int v : elements_[e].free) {
      if (v < 0) continue;
      result[v] += elements_[e].volume * rotations[e];
      volume[v] += elements_[e].volume;
    }
  }
  for (int v = 0; v < free_count_; ++v) result[v] = rotation_of(result[v] / volume[v]);
  return result;
}

Eigen::VectorXd SolidElements::elastic_force(const Eigen::VectorXd& displacement, const Rotations& rotations) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(displacement.size());
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Eigen::Matrix3d& r = rotations[e];
    const Eigen::Matrix3d stretch = r.transpose() * (one + gradient_of(elements_[e], displacement));
    spread(elements_[e], r * stress(0.5 * (stretch + stretch.transpose()) - one), force);
  }
  return force;
}

double SolidElements::energy(const Eigen::VectorXd& displacement, const Rotations& rotations) const {
  double sum = 0;
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Eigen::Matrix3d stretch = rotations[e].transpose() * (one + gradient_of(elements_[e], displacement));
    const Eigen::Matrix3d strain = 0.5 * (stretch + stretch.transpose()) - one;
    sum += elements_[e].volume * 0.5 * strain.cwiseProduct(stress(strain)).sum();
  }
  return sum;
}

Eigen::VectorXd SolidElements::stiffness_times(const Rotations& rotations, const Eigen::VectorXd& vector) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(vector.size());
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Eigen::Matrix3d& r = rotations[e];
    const Eigen::Matrix3d stretch = r.transpose() * gradient_of(elements_[e], vector);
    spread(elements_[e], r * stress(0.5 * (stretch + stretch.transpose())), force);
  }
  return force;
}

Eigen::SparseMatrix<double> assemble_mass(const TetrahedralMesh& mesh, double density, const FreeVertices& free) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(10 * mesh.tetrahedra.size());
  for (const auto& tetrahedron : mesh.tetrahedra) {
    const double share = density * edges_of(mesh, tetrahedron).determinant() / 6 / 20;
    for (const int a : tetrahedron) {
      for (const int b : tetrahedron) {
        const int row = free.number[a], column = free.number[b];
        if (column >= 0 && row >= column) entries.emplace_back(row, column, a == b ? 2 * share : share);
      }
    }
  }
  Eigen::SparseMatrix<double> mass(free.count, free.count);
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

Eigen::VectorXd vertex_masses(const TetrahedralMesh& mesh, double density, const FreeVertices& free) {
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(free.count);
  for (const auto& tetrahedron : mesh.tetrahedra) {
    const double quarter = density * edges_of(mesh, tetrahedron).determinant() / 6 / 4;
    for (const int v : tetrahedron) {
      if (free.number[v] >= 0) masses[free.number[v]] += quarter;
    }
  }
  return masses;
}

}  // namespace greenloop::offline
