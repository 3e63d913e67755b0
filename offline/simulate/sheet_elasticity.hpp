#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

using Places = std::vector<Eigen::Vector3d>;

/// The angle between two triangles that have an edge in common, -pi to pi, 0 if flat, and how it changes with the
/// places of the edge's ends and of the corner across on either side. Gradients are zero if a triangle has no area.
struct HingeAngle {
  double angle = 0;
  std::array<Eigen::Vector3d, 4> gradient{};
};
[[nodiscard]] HingeAngle hinge_angle(const std::array<Eigen::Vector3d, 4>& places);

/// What resists a sheet's deformation, as constraints that give way by their compliance (XPBD: Macklin, Müller,
/// Chentanez 2016): edges as springs, and the angle between the triangles at each inner edge, around the angle that it
/// has as sewn (discrete shells: Grinspun et al. 2003).
class SheetElasticity {
 public:
  /// Stretch stiffness in N/m, bending stiffness in N m, both above 0. Masses of vertices in kg, 0: held.
  SheetElasticity(const TriangleMesh& sewn, double stretch, double bend, const std::vector<double>& masses);

  /// One sweep over all constraints, in the order of their vertices. Work: linear.
  void relax(double time_step, Places& places) const;

  /// The largest length of an edge over what it is as sewn; infinity if places are not finite. Work: linear.
  [[nodiscard]] double largest_stretch(const Places& places) const;

 private:
  struct Spring {
    int a = 0, b = 0;
    double length = 0, compliance = 0;
  };
  /// C = scale * (angle - sewn); the first two corners are the edge's.
  struct Hinge {
    std::array<int, 4> corners{};
    double scale = 0;  ///< sqrt(3 / area) times the edge
    double sewn = 0;
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
