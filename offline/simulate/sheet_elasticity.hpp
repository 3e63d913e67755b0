#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

using Places = std::vector<Eigen::Vector3d>;

/// What resists a sheet's deformation, as constraints that give way by their compliance (XPBD: Macklin, Müller,
/// Chentanez 2016): edges as springs, and the bend of each inner edge (the energy of Bergou et al. 2006, around the
/// bend that it has as sewn, whichever way).
class SheetElasticity {
 public:
  /// Stretch stiffness in N/m, bending stiffness in N m, both above 0. Masses of vertices in kg, 0: held.
  SheetElasticity(const TriangleMesh& sewn, double stretch, double bend, const std::vector<double>& masses);

  /// One sweep over all constraints, in the order of their vertices. Work: linear.
  void relax(double time_step, Places& places) const;

 private:
  struct Spring {
    int a = 0, b = 0;
    double length = 0, compliance = 0;
  };
  /// C = |curvature| - bend; the first two corners are the edge's.
  struct Hinge {
    [[nodiscard]] Eigen::Vector3d curvature(const Places& places) const;

    std::array<int, 4> corners{};
    std::array<double, 4> weights{};
    double bend = 0;
  };

  [[nodiscard]] double mobility(int vertex) const { return mobilities_[static_cast<std::size_t>(vertex)]; }
  void relax(const Spring& spring, double time_step, Places& places) const;
  void relax(const Hinge& hinge, double time_step, Places& places) const;

  std::vector<double> mobilities_;  // 1/kg
  std::vector<Spring> springs_;
  std::vector<Hinge> hinges_;
  double bend_compliance_;
};

/// kg, of each vertex: a third of its triangles.
[[nodiscard]] std::vector<double> lumped_masses(const TriangleMesh& mesh, double density);

}  // namespace greenloop::offline
