#pragma once

#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/patch_flattening.hpp"
#include "offline/remesh/quadric.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {

/// A base mesh and the bijection between it and the surface it was decimated from: the composition of one flattened
/// patch per collapse (Liu, Kim, Chaudhuri, Aigerman, Jacobson, "Neural Subdivision", ACM TOG 39(4), 2020, section 5).
struct SelfParameterization {
  std::vector<std::array<int, 3>> base_triangles;  ///< over 0 .. base_vertices.size()-1
  std::vector<Eigen::Vector3d> base_vertices;      ///< where the decimation left them: near the surface, not on it
  std::vector<Quadric> base_planes;                ///< mean squared distance to the planes a base vertex stands for
  std::vector<int> base_ids;                       ///< the triangle of the input that base triangle t descends from
  std::vector<FlatPatch> changes;                  ///< collapses and edge flips, in the order they were made
  std::vector<int> base_origin;                    ///< the input's vertex that each base vertex descends from
  Features base_features;                          ///< the input's chains as edges of the base, in the same order

  /// Carries points on base triangles (SurfacePoint::triangle indexes base_triangles) to the input's triangles.
  /// Work: linear in the points met by the changes, about points * log(input / base vertices).
  [[nodiscard]] std::vector<SurfacePoint> to_input(std::vector<SurfacePoint> points) const;
};

/// Decimates a closed manifold mesh to `base_vertices` vertices, or to as few as stay a valid closed triangulation
/// (no two edges with the same ends) if that is more. Collapses go by the increase of quadric error (Garland,
/// Heckbert 1997) plus a share of the scatter of the area each vertex stands for, which keeps the base even.
/// Chains of features stay chains of edges, whose vertices are the input's; corners stay (Lee et al. 1998,
/// section 3.3). Every choice is made by value then index: the same input gives the same bits.
[[nodiscard]] SelfParameterization decimate(const TriangleMesh& mesh, int base_vertices, const Features& features = {});

}  // namespace greenloop::offline
