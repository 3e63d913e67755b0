#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/simulate/simulator.hpp"
#include "offline/simulate/solid_dynamics.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {

/// A solid on a support that is struck, and the surface that hangs on it.
struct ElasticSolidScene {
  TetrahedralMesh mesh;             ///< m
  std::vector<std::uint8_t> fixed;  ///< per vertex, nonzero = held by the support
  Material material;
  double density = 0;            ///< kg/m^3
  double mass_damping = 0;       ///< 1/s
  double stiffness_damping = 0;  ///< s
  double time_step = 0;          ///< s
  Strain strain = Strain::linear;
  Newmark newmark;
  std::vector<Eigen::Vector3d> shown;       ///< m, its vertices at rest
  std::vector<std::uint32_t> triangles;     ///< [triangles][3]
  std::vector<Eigen::Vector3d> velocities;  ///< m/s, by which each impulse changes the support's
  double rest = 0;                          ///< m, what counts as at rest moves and is displaced less
};

/// Seen from its support, which each impulse gives another velocity; afterwards it moves freely. It is at rest when no
/// vertex is displaced by more than `rest`, nor as fast as one that swings so far at the lowest frequency.
class ElasticSolid final : public Simulator {
 public:
  /// Throws as SolidDynamics does. Work: three factorisations, shown vertices times tetrahedra.
  explicit ElasticSolid(ElasticSolidScene scene);

  [[nodiscard]] double time_step() const override { return scene_.time_step; }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const override { return scene_.triangles; }
  [[nodiscard]] std::size_t vertices() const override { return scene_.shown.size(); }
  void reset() override;
  void apply(std::size_t impulse) override;
  void step() override;
  void positions(std::span<float> out) const override;
  [[nodiscard]] bool at_rest() const override;
  [[nodiscard]] std::vector<double> state() const override;
  void restore(std::span<const double> state) override;

  [[nodiscard]] double lowest_frequency() const { return lowest_frequency_; }  ///< 1/s, angular

 private:
  ElasticSolidScene scene_;
  SolidDynamics dynamics_;
  double lowest_frequency_;
  Interpolation binding_;               // shown vertices from free ones
  std::vector<Eigen::VectorXd> jumps_;  // m/s, of each impulse
  SolidDynamics::State state_;
};

}  // namespace greenloop::offline
