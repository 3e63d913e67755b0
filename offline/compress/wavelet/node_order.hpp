#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop::offline {

/// The nodes whose displacement is stored: the free ones among `flags` (layout::NodeFlag per node) that can be touched
/// or are read, closed under free parents, so that every such node can be transformed with its ancestors.
/// Returns `flags` with node_domain set on exactly those. Throws std::invalid_argument if the sizes differ.
/// Work: linear in the nodes. Offline only.
[[nodiscard]] std::vector<std::uint32_t> mark_domain(const SemiRegularMesh& mesh, std::vector<std::uint32_t> flags);

/// A mesh whose nodes stand in the model file's order.
struct OrderedMesh {
  SemiRegularMesh mesh;
  std::vector<std::size_t> source;  ///< source[node] = its index in the mesh that was given

  /// Per-node values of the given mesh in the new order.
  template <typename T>
  [[nodiscard]] std::vector<T> reorder(const std::vector<T>& values) const {
    std::vector<T> ordered;
    ordered.reserve(source.size());
    for (const std::size_t old : source) ordered.push_back(values.at(old));
    return ordered;
  }
};

/// Reorders the vertices within each level: domain nodes (layout::node_domain in `flags`) first, each group along a
/// Morton curve through the bounding box, so that neighbours stand near each other. Levels keep their vertices.
/// Throws std::invalid_argument if `flags` has the wrong size or the mesh has no extent. Work: n log n. Offline only.
[[nodiscard]] OrderedMesh order_nodes(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags);

}  // namespace greenloop::offline
