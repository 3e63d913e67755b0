#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/impulse_response.hpp"

namespace greenloop::bench {

/// Displacements of all vertices by some modes; thread CPU time, medians.
struct SynthesisFigures {
  std::uint32_t rank = 0;
  std::uint32_t planes = 0;  ///< of the modes' values
  std::uint32_t vertices = 0;
  double error = 0;  ///< of truncation to this rank, relative, from the file
  double us = 0;     ///< of a step with them
  double frames_per_s = 0;
  double bytes = 0;            ///< values read and displacements written
  double bandwidth_ratio = 0;  ///< us over what reading as many bytes takes, in the same run
  std::uint64_t work = 0;      ///< units of the step
};

/// Colours of all vertices by all modes of light, without displacements; likewise.
struct ColourFigures {
  std::uint32_t rank = 0;
  double us = 0;
  double frames_per_s = 0;
  double bytes = 0;
  double bandwidth_ratio = 0;
  std::uint64_t work = 0;
};

/// What motions cost.
struct MotionFigures {
  double step_us = 0;  ///< of a step without displacements, one impulse in 64 steps
  std::uint64_t step_work = 0;
  std::vector<SynthesisFigures> synthesis;  ///< by all modes, then as the budget shrinks
  std::optional<ColourFigures> colours;     ///< none: the model has no appearance
};

/// Measures an impulse response model. rounds: steps a figure. Throws std::runtime_error if no body can be made.
[[nodiscard]] MotionFigures measure_motion(const Model& model, std::size_t rounds);

}  // namespace greenloop::bench
