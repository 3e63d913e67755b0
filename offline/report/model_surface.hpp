#pragma once

#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/view.hpp"
#include "offline/report/camera.hpp"

namespace greenloop::offline {

/// The surface of a model file as a mesh: vertices are the file's nodes, in the file's order.
struct ModelSurface {
  SemiRegularMesh mesh;
  std::vector<std::uint32_t> flags;  ///< layout::NodeFlag per node

  [[nodiscard]] std::size_t count(layout::NodeFlag flag) const;
  /// Nodes and triangles of one level, 0..finest_level.
  [[nodiscard]] VisibleSurface level(int l) const;
  /// Per node of that level: may be a contact.
  [[nodiscard]] std::vector<char> touchable(int l) const;
};

/// Copies nodes, base triangles and parents out of a verified model. Throws std::runtime_error if the levels are no
/// subdivision of each other. Work: linear.
[[nodiscard]] ModelSurface model_surface(const ModelView& model);

}  // namespace greenloop::offline
