#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "formats/write/impulse_response.hpp"
#include "offline/appearance/radiance_transfer.hpp"

namespace greenloop::offline {

/// What the appearance of a model is asked for.
struct AppearanceGoal {
  TransferGoal transfer;
  double error = 0.1;          ///< of states that light is not computed for, relative to the variation
  std::uint32_t rank = 12;     ///< modes at most, 1..layout::most_transfer_modes
  std::uint32_t states = 64;   ///< that light is computed for, at most
  std::uint32_t held_out = 8;  ///< states on which the error is measured
};

/// How far the transfer of held-out states is off with so many states that light was computed for.
struct SampledError {
  std::uint32_t states = 0, rank = 0;
  double error = 0;        ///< of the interpolated transfer, relative to the variation about the mean
  double truncation = 0;   ///< of the transfers computed, likewise
  double of_transfer = 0;  ///< error, relative to the transfer itself
};

/// The appearance of a model, and what it cost.
struct Appearance {
  AppearanceData data;
  std::vector<double> singular_values;  ///< of the transfers' differences to their mean, falling
  std::vector<SampledError> sampling;   ///< as states were added
  double noise = 0;  ///< of a held-out state's transfer against one by 4 times the rays, relative to the transfer
};

/// Radiance transfer of all rows of a model as it shows them (James & Fatahalian 2003, section 4): computed for few
/// representatives of the states, reduced to few modes by singular values, between them by radial basis functions over
/// q_u. Representatives are doubled until held-out states are right within the goal, or there are as many as it allows.
/// reflectance: of each vertex. Throws std::runtime_error if no light falls on the model or it has fewer than three
/// rows that differ. progress: states done of those begun. Memory: 192 bytes for each vertex and state computed. Work:
/// that of radiance_transfer for each.
[[nodiscard]] Appearance appearance_of(const ImpulseResponseData& model, const std::vector<Eigen::Array3f>& reflectance,
                                       const AppearanceGoal& goal,
                                       const std::function<void(std::uint32_t done, std::uint32_t states)>& progress);

}  // namespace greenloop::offline
