#pragma once

#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/surface.hpp"
#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {

/// A surface in even triangles, and where its vertices lie on the surface that it stands for.
struct EvenMesh {
  TriangleMesh mesh;
  Features features;               ///< its edges along the chains of the original, in the same order
  std::vector<BoundPoint> origin;  ///< of each vertex, on the original
  bool settled = true;             ///< false: it was given up, half done, as more splits only made more long edges

  /// A point of `mesh` on the original: the closest one; along a chain, by length.
  [[nodiscard]] SurfacePoint on_original(const BoundPoint& at, const FeatureCurves& original_curves,
                                         const TriangleTree& tree) const;

 private:
  [[nodiscard]] SurfacePoint on_chain(const BoundPoint& at, const std::array<int, 3>& corners,
                                      const FeatureCurves& original_curves) const;
};

/// Triangulates `original` anew with edges of about `edge_length` (its unit): edges above 4/3 of it are split, below
/// 4/5 collapsed, flipped towards Delaunay, and vertices slide along the original to the centre of their neighbours
/// (Botsch, Kobbelt, "A remeshing approach to multiresolution modeling", 2004, section 4). Chains stay chains of edges
/// and corners stay where they are. Every vertex lies on the original and never leaves its sheet. The same input gives
/// the same bits. Work: linear in the triangles of both: where splits would make more than four times those given and
/// 16 times those wanted, it is given up (`settled`). `original` has the edges of `features` as sharp ones.
[[nodiscard]] EvenMesh even_mesh(const Surface& original, const Features& features, const FeatureCurves& curves,
                                 double edge_length);

}  // namespace greenloop::offline
