#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// A face crosses the edge of the lattice from `point` to its next neighbour along `axis`.
struct Crossing {
  std::uint32_t point;
  int face;
  float at;  ///< how far from `point`, 0 to 1
  std::uint8_t axis;
  bool alone = true;  ///< no other face crosses the same edge

  [[nodiscard]] std::size_t next_point(const Lattice& lattice) const { return point + lattice.stride(axis); }
  [[nodiscard]] Eigen::Vector3d place(const Lattice& lattice) const;
};

/// As many crossings are kept, 16 bytes each.
inline constexpr std::size_t most_crossings = std::size_t{1} << 25;

/// Every crossing of a face and an edge of the lattice; boundaries of faces belong to them, so that nothing passes
/// between two faces with a common edge. Ordered by face. Throws std::runtime_error if there are more than
/// most_crossings. Work: linear in the faces and the crossings.
[[nodiscard]] std::vector<Crossing> find_crossings(const TriangleMesh& mesh, const Lattice& lattice);

/// For each face the area that one of its crossings stands for.
[[nodiscard]] std::vector<double> area_of_crossing(const TriangleMesh& mesh);

/// For each lattice point the axes, as bits, along which the edge to the next point is crossed.
[[nodiscard]] std::vector<std::uint8_t> crossed_axes(const std::vector<Crossing>& crossings, const Lattice& lattice);

}  // namespace greenloop::offline
