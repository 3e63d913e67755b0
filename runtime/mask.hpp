#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

class Surface;  // runtime/surface.hpp

/// A point of the surface: three corners and the share of each, as Surface::NearestPoint has it. A node is that node
/// with a share of 1.
struct MeshPoint {
  std::uint32_t node[3] = {};  ///< file indices
  float weight[3] = {};        ///< 0..1 with sum 1
};

constexpr MeshPoint at_node(std::uint32_t node) { return {{node, node, node}, {1, 0, 0}}; }

/// A scalar pressure mask (James & Pai 2001, section 6.1): the nodes that a force is spread over, and the part of it on
/// each, area times pressure. A node may stand in it more than once: its parts add up.
struct Mask {
  std::span<const std::uint32_t> node;  ///< file indices of touchable nodes
  std::span<const float> weight;        ///< of each, >= 0; their sum is 1, or the share of the force that it takes
};

/// The mask of a point-like contact: of every corner i the collocated linear function rho_i(x) = max(0, 1 - |x - x_i| /
/// radius), integrated over the surface with each touchable node's linear function, divided by the sum of these
/// (sections 6.1.1 and 6.1.2, where areas of nodes stand for the integrals, which lets the mask depend on where nodes
/// happen to be), and of these the mean by the point's weights (equation 35). What corners that are not touchable take
/// has no part in it: it goes straight into what holds them, so that the weights sum to less than 1 there. A radius
/// below a 24th of the edges around gives the node alone.
/// surface: triangles of a mesh level of it. radius: m. node, weight: memory for the mask, which refers to it; as many
/// as there are nodes of triangles within the radius of the corners. Empty if they do not fit, a node is not of that
/// level, nothing is within the radius, or a number is not finite. For the loop; work: some 100 operations per triangle
/// of the level, 500 to 5000 per triangle within the radius, and the square of the mask's nodes.
[[nodiscard]] Mask make_mask(const Surface& surface, std::uint32_t level, const MeshPoint& point, float radius,
                             std::span<std::uint32_t> node, std::span<float> weight) noexcept;

/// A mask whose force has a direction of its own at each node, in fixed proportion: pressure along the surface's
/// normals, a torque, or a single node's normal. An amount x of it is the forces x part[k]; what it measures of
/// displacements u is the sum of part[k].u[k], so that force times displacement is work. Three of them are the axes of
/// a tensor mask (James & Pai 2001, section 6.1, footnote 7).
struct DirectedMask {
  std::span<const std::uint32_t> node;  ///< file indices of touchable nodes
  std::span<const Vec3> part;           ///< of each
};

/// A mask along a unit vector: its amounts are newtons, and it measures the mean displacement along the vector, m.
/// part: memory for it, as many as the mask has nodes; empty if they do not fit. For the loop; linear in the nodes.
[[nodiscard]] DirectedMask direct_mask(const Mask& mask, Vec3 direction, std::span<Vec3> part) noexcept;

/// The torque of a mask about a unit vector through its centre: forces w (a x r), which have no sum. Its amounts are
/// newton metres, and it measures the mean rotation about the axis, rad. Memory as of direct_mask; empty, too, if a
/// node is not of the model, or no node is off the axis. For the loop; linear in the nodes.
[[nodiscard]] DirectedMask make_torque_mask(const Model& model, const Mask& mask, Vec3 axis,
                                            std::span<Vec3> part) noexcept;

}  // namespace greenloop
