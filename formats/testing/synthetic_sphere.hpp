#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/layout.hpp"

namespace greenloop {

/// The body of formats/testing/synthetic_model.hpp. Nodes coarse to fine and, within a level, the domain first.
struct SyntheticSphere {
  using Point = std::array<double, 3>;
  using Triangle = std::array<std::uint32_t, 3>;

  static constexpr double radius = 0.1;  ///< m

  std::vector<Point> positions;
  std::vector<std::array<std::uint32_t, 2>> parents;
  std::vector<layout::StencilRecord> stencils;  // of every node, the Butterfly scheme's; meaningless on level 0
  std::vector<std::uint32_t> begin = {0};       // of each level, then the number of nodes
  std::vector<Triangle> base, finest;
  std::vector<std::uint32_t> flags;
  std::vector<double> areas;

  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  [[nodiscard]] std::uint32_t count() const { return begin.back(); }
  [[nodiscard]] bool has(std::uint32_t node, layout::NodeFlag flag) const { return (flags[node] & flag) != 0; }
};

/// An octahedron split levels - 1 times. Touchable: z >= `touchable_above` radii.
[[nodiscard]] SyntheticSphere make_sphere(std::uint32_t levels, double touchable_above);

[[nodiscard]] double distance(const SyntheticSphere::Point& x, const SyntheticSphere::Point& y);

/// Whether the Butterfly stencil of a node is used: it is not on the lowest third of the sphere, so that there are
/// both.
[[nodiscard]] bool uses_stencil(const SyntheticSphere& sphere, std::uint32_t node);

/// The lifting weight of every node towards its parents: docs/theory.md. Zero towards, and of, nodes outside the
/// domain. `butterfly`: prediction by stencils where they are used.
[[nodiscard]] std::vector<std::array<double, 2>> lifting_weights(const SyntheticSphere& sphere, bool butterfly);

}  // namespace greenloop
