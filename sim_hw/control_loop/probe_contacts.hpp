#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/algebra/double3.hpp"
#include "runtime/elastostatic.hpp"
#include "sim_hw/body/body_surface.hpp"
#include "sim_hw/control_loop/node_grid.hpp"

namespace greenloop {

/// A sphere pushed into the body.
struct Probe {
  Double3 centre;  ///< m
  Double3 axis;    ///< unit vector, where it pushes
};

/// Which nodes the probes hold, and where: unilateral contact by an active set that takes one step per cycle.
///
/// A touchable node whose undeformed place lies inside a probe, on a side of the body that faces it, is held where the
/// probe's axis through the node leaves the sphere. It is added when its place in the last known field lies inside the
/// sphere too (it would penetrate), stays while it is pushed, and is released in the cycle after one in which it had to
/// be pulled. Of more than `max_contacts` the deepest are kept; equal depths go by node.
class ProbeContacts {
 public:
  /// Start-up; the only place that allocates. Spheres of `radius` m.
  ProbeContacts(const BodySurface& surface, double radius, std::uint32_t max_contacts);

  /// The contacts of this cycle by increasing node. `field`: [4 * node_count] m, the displacement last known.
  /// Loop-safe. Work: for every probe the touchable nodes near it, and sorting these.
  [[nodiscard]] std::span<const Constraint> find(std::span<const Probe> probes, std::span<const float> field) noexcept;

  /// Remembers which of the last contacts were pushed. `force`: [3 * contacts] N, what holds them. Loop-safe.
  void settle(std::span<const Probe> probes, std::span<const float> force) noexcept;

  /// Number of the probe that holds each of the last contacts.
  [[nodiscard]] std::span<const std::uint8_t> holder() const noexcept { return {holder_.data(), count_}; }

 private:
  struct Candidate {
    double depth;  ///< m, along the axis to the sphere's surface
    std::uint32_t node;
    std::uint8_t probe;
  };
  static constexpr std::uint8_t nobody = 0xff;
  static constexpr double least_facing = 0.2;  ///< cosine between the surface's inward normal and the axis
  static constexpr double margin = 1e-3;  ///< of the radius: nearer to the sphere's surface is touching, not inside

  void gather(const Probe& probe, std::uint8_t number, std::span<const float> field) noexcept;
  void choose_deepest() noexcept;
  void place(std::span<const Probe> probes) noexcept;

  const BodySurface* surface_;
  double radius_;
  NodeGrid grid_;
  std::vector<std::uint8_t> pushed_by_;  ///< [node] the probe that pushed it in the last cycle
  std::vector<Candidate> candidate_;     ///< room for every touchable node and probe
  std::size_t candidate_count_ = 0;
  std::vector<Constraint> contact_;
  std::vector<std::uint8_t> holder_;
  std::size_t count_ = 0;
};

}  // namespace greenloop
