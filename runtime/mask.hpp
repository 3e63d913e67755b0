#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/model.hpp"

namespace greenloop {

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
/// radius) on the touchable nodes of the domain, times their areas, divided by the sum of the products (sections 6.1.1
/// and 6.1.2), and of these the mean by the point's weights (equation 35). What corners that are not touchable take has
/// no part in it: it goes straight into what holds them, so that the weights sum to less than 1 there.
/// area: [nodes of some levels, from the coarsest on] m^2, Surface::areas; nodes after them have no part. radius: m.
/// node, weight: memory for the mask, which refers to it; as many as there are nodes within the radius of the corners.
/// Empty if they do not fit, a node is not of `area` or of the model, nothing is within the radius, or a number is not
/// finite. For the loop; work: some 60 operations per node of `area`.
[[nodiscard]] Mask make_mask(const Model& model, std::span<const float> area, const MeshPoint& point, float radius,
                             std::span<std::uint32_t> node, std::span<float> weight) noexcept;

}  // namespace greenloop
