#pragma once

#include <Eigen/Core>
#include <vector>

#include "offline/report/camera.hpp"
#include "offline/report/figure.hpp"
#include "offline/report/model_surface.hpp"
#include "offline/report/trace.hpp"

namespace greenloop::offline {

/// A displaced body as it is drawn.
struct DrawnDisplacement {
  std::vector<Eigen::Vector3d> displacement;  ///< m, one per node
  std::vector<Eigen::Vector3d> magnified;     ///< the same times `factor`
  double factor = 1;
  double largest = 0;  ///< m
  std::size_t largest_node = 0;
};

/// With the factor of exaggeration (mesh_picture.hpp). `displacement` has one entry per position.
[[nodiscard]] DrawnDisplacement drawn_displacement(const std::vector<Eigen::Vector3d>& positions,
                                                   std::vector<Eigen::Vector3d> displacement);

/// The deformed body with its colour bar; arrows for the forces of `cycle` (the one the snapshot is of) if not null.
[[nodiscard]] Figure body_figure(const VisibleSurface& surface, const DrawnDisplacement& drawn, const ViewFrame& frame,
                                 const TraceCycle* cycle);

/// Base and finest mesh side by side, with what is touchable and fixed.
[[nodiscard]] Figure mesh_figure(const ModelSurface& surface, const ViewFrame& frame);

}  // namespace greenloop::offline
