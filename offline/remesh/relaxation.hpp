#pragma once

#include <functional>
#include <vector>

#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/midpoint_refinement.hpp"
#include "offline/remesh/quadric.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {

/// Slides the vertices of `connectivity` along `surface` until its finest triangles are as equilateral and as equal
/// as its connectivity allows. Minimises the sum over finest triangles of MIPS^2 times the area distortion
/// (Degener, Meseth, Klein 2003, with theta = 1/2), against equilateral triangles of the mean area; areas are signed
/// by the surface's normal, with the regularisation of Garanzha et al. 2021 where triangles are still turned over.
/// Coarse vertices move with their hat functions over the finest level, so that mass flows across the surface.
/// Where an angle is then below `least_angle`, radians, vertices around it move one by one to widen it.
/// A vertex only ever walks on the surface; one bound to a chain moves along it, one at a corner stays. `progress` gets
/// the fraction done.
[[nodiscard]] std::vector<BoundPoint> relax(const Surface& surface, const FeatureCurves& curves,
                                            const SemiRegularMesh& connectivity, std::vector<BoundPoint> points,
                                            const std::vector<Quadric>& base_planes, double least_angle,
                                            const std::function<void(double)>& progress);

}  // namespace greenloop::offline
