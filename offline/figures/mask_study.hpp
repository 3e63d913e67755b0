#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "offline/figures/nodule.hpp"
#include "offline/report/figure.hpp"
#include "offline/sources/fem/fem_source.hpp"

namespace greenloop::offline {

// Point-like contact with and without vertex pressure masks, after table 1 and figure 7 of James & Pai 2001, on finite
// elements.

/// A nodule filled with linear or quadratic elements, 1 MPa, Poisson's ratio 0.4. Start: a factorisation. Throws
/// std::runtime_error if it cannot be filled or solved.
class MaskedBody {
 public:
  explicit MaskedBody(Nodule nodule, Elements elements);

  [[nodiscard]] const Nodule& nodule() const { return nodule_; }
  [[nodiscard]] const std::vector<double>& area() const { return area_; }     ///< m^2, per vertex
  [[nodiscard]] const std::vector<int>& free_nodes() const { return free_; }  ///< increasing

  /// What a stiffness is of: a vertex by itself, a vertex under its mask (equation 32), a mask that is held, by its
  /// force and mean displacement.
  enum class Of { vertex, masked_vertex, held_mask };

  /// Of each of these free vertices, N/m. radius: m, of the linear mask. Work: three solves a vertex.
  [[nodiscard]] std::vector<Eigen::Matrix3d> stiffness(std::span<const int> nodes, double radius, Of of);

 private:
  MaskedBody(Nodule nodule, TetrahedralMesh volume, Elements elements);
  void add_mask(int node, double radius, int column, std::vector<Eigen::Triplet<double>>& entries) const;

  Nodule nodule_;
  std::vector<double> area_;
  std::vector<int> free_;
  TetrahedralMesh volume_;
  std::vector<std::uint8_t> volume_fixed_;
  Interpolation interpolation_;
  FemSource source_;
};

/// A row of table 1: the vertex in the middle of the top; Frobenius norms, N/m.
struct RefinedStiffness {
  int vertices = 0;
  double edge = 0;  ///< m, mean
  double single = 0;
  double masked = 0;
  double held = 0;
};

/// On nodules split 1 .. `splits` times; radius: of the mask, in mean edges of the first.
[[nodiscard]] std::vector<RefinedStiffness> refine_stiffness(int splits, double radius, Elements elements,
                                                             const std::function<void(int)>& progress = {});

/// The normal force per depth of a point that slides once around the axis, where it is the same everywhere on the body,
/// on an uneven triangulation.
struct SlidingForce {
  std::vector<double> azimuth;               ///< rad
  std::vector<double> single, masked, held;  ///< N/m

  /// Largest less smallest over the mean.
  [[nodiscard]] static double ripple(const std::vector<double>& force);
};

/// At the polar angle, rad; radius of the mask: m. Work: six solves for each vertex on the way.
[[nodiscard]] SlidingForce slide_around(MaskedBody& body, double polar, double radius, int points);

/// Figure 7: areas, the stiffness of every free vertex, single and masked, and the force on the way around. Work: six
/// solves a free vertex.
[[nodiscard]] Figure masks_figure(MaskedBody& body, double radius, const SlidingForce& force);

}  // namespace greenloop::offline
