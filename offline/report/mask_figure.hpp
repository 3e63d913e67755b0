#pragma once

#include <string>
#include <vector>

#include "formats/write/model_file.hpp"
#include "offline/report/camera.hpp"
#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// A surface at rest, each vertex coloured by its value over the largest one; under it the name and the range of those
/// that are above zero. `unit` takes an SI prefix. One value a vertex, 0 or more.
[[nodiscard]] SvgCanvas value_panel(const VisibleSurface& surface, const ViewFrame& frame, const std::string& name,
                                    const std::string& unit, const std::vector<double>& value);

/// The Frobenius norm of the stiffness of every touchable node under a linear mask (James & Pai 2001, equation 32), by
/// the runtime, N/m; 0 of the others. radius: m; one below the node spacing makes single nodes of masks. Throws
/// std::runtime_error if a mask has more than 4,097 nodes, or the runtime refuses the model. Work: one
/// masked_compliance a node.
[[nodiscard]] std::vector<double> masked_stiffness(const ModelFile& model, double radius);

/// Figure 7 of James & Pai 2001: single nodes beside masked ones. `surface` is the finest level.
[[nodiscard]] Figure masked_stiffness_figure(const ModelFile& model, const VisibleSurface& surface, double radius);

}  // namespace greenloop::offline
