#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/scene/sheet.hpp"
#include "offline/simulate/loop_subdivision.hpp"
#include "offline/simulate/sheet_contacts.hpp"
#include "offline/simulate/sheet_elasticity.hpp"
#include "offline/simulate/simulator.hpp"

namespace greenloop::offline {

/// How the support of sheets moves from an impulse to the next.
struct SupportMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  double turning = 0;                                  ///< 1/s, about the y axis through the origin
};

/// Thin sheets on a support, which moves or turns. Places are seen from the support.
struct SheetScene : Sheet {
  TriangleMesh mesh;                ///< m, as sewn: without load it is so
  std::vector<std::uint8_t> fixed;  ///< per vertex, nonzero = held by the support
  double time_step = 0;             ///< s, between frames
  double rest = 0;                  ///< m, what is displaced less, and moves less in a second, is at rest
  std::vector<SupportMotion> impulses;
};

/// Cloth and leaves that touch themselves, each other and rigid shapes, by position based dynamics with compliance in
/// small steps (XPBD: Macklin et al. 2019), seen from the support: gravity along -y, Euler, centrifugal and Coriolis
/// forces where it turns. What this cannot do: docs/simulating.md.
class ThinSheets final : public Simulator {
 public:
  /// Lets the sheets settle. Throws std::invalid_argument for values out of range.
  explicit ThinSheets(SheetScene scene);

  [[nodiscard]] double time_step() const override { return scene_.time_step; }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const override { return triangles_; }
  [[nodiscard]] std::size_t vertices() const override { return static_cast<std::size_t>(shown_.weights.rows()); }
  void reset() override { restore(rest_); }
  void apply(std::size_t impulse) override;
  void step() override { pass(scene_.damping); }
  void positions(std::span<float> out) const override;
  /// Never while the support moves through air, or turns.
  [[nodiscard]] bool at_rest() const override;
  [[nodiscard]] std::vector<double> state() const override;
  void restore(std::span<const double> state) override;

 private:
  void pass(double damping);
  void pass_substep(double damping, double time_step);
  [[nodiscard]] Places normals() const;
  void keep_outside(double time_step, const Places& before);

  SheetScene scene_;
  FinerSheet shown_;
  std::vector<std::uint32_t> triangles_;
  SheetElasticity elasticity_;
  SheetContacts contacts_;
  Places x_, v_;
  SupportMotion motion_;
  std::vector<double> rest_;  // the state at rest
};

}  // namespace greenloop::offline
