#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "offline/report/camera.hpp"
#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// What one unit of a load does to every node of a model, in file order, m; zero outside the domain. Work: an inverse
/// transform.
[[nodiscard]] std::vector<Eigen::Vector3d> load_displacement(const ModelView& model, std::uint32_t load);

/// The body under each of its loads, the first six: accelerations of 9.81 m/s^2, pressures of 1 kPa. `surface` is the
/// finest level; the model has loads.
[[nodiscard]] Figure loads_figure(const ModelView& model, const VisibleSurface& surface);

}  // namespace greenloop::offline
