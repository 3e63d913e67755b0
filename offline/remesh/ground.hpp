#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/even_mesh.hpp"
#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/self_parameterization.hpp"
#include "offline/remesh/surface.hpp"
#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {

/// The surface that bases are made from: an input as it is, or triangulated evenly. Not to be copied or moved.
class Ground {
 public:
  /// `input` in units of its diagonal, its own triangles.
  explicit Ground(TriangleMesh input);
  /// `input` in even triangles of `edge_length`, which keep `features`.
  Ground(TriangleMesh input, const Features& features, double edge_length);
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  /// A base of `vertices`, or as few as keep features and topology.
  [[nodiscard]] SelfParameterization base(int vertices) const;

  /// A base split `levels` times: its connectivity, and every vertex's place on the input.
  struct Attempt {
    SemiRegularMesh mesh;
    std::vector<SurfacePoint> places;
  };
  /// Triangles of less than `least_angle`, radians, are widened where few are. `progress` gets the fraction done.
  [[nodiscard]] Attempt attempt(const SelfParameterization& base, int levels, double least_angle,
                                const std::function<void(double)>& progress) const;

  /// Whether the surface is as even as was asked; no base over one that is not will do.
  [[nodiscard]] bool settled() const { return !even_ || even_->settled; }

  [[nodiscard]] const Surface& surface() const { return even_ ? *even_surface_ : input_; }

 private:
  [[nodiscard]] const FeatureCurves& curves() const { return even_ ? *even_curves_ : input_curves_; }

  Surface input_;
  FeatureCurves input_curves_;
  std::optional<TriangleTree> input_tree_;
  std::optional<EvenMesh> even_;
  std::optional<Surface> even_surface_;
  std::optional<FeatureCurves> even_curves_;
};

}  // namespace greenloop::offline
