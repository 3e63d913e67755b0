#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace greenloop::offline {

/// Modes and rows as whole numbers: the form of layout/impulse_response.hpp.
struct QuantisedModes {
  std::uint32_t planes = 1;               ///< of 8 bits in a value
  std::vector<float> quanta;              ///< m, [blocks of 16 vertices], common to all modes
  std::vector<float> amplitudes;          ///< m, [modes]: the largest coordinate of any row
  std::vector<std::int16_t> values;       ///< [3 vertices][modes]
  std::vector<std::int16_t> coordinates;  ///< [rows][modes]
  double error = 0;                       ///< m, measured: root of the summed squares over rows and vertices
};

/// modes: [3 vertices][modes], rows: coordinates, m, [modes][rows]. The error is that of the displacements of all rows,
/// by the Gram matrix of the modes before and after. Work: vertices * modes^2 + rows * modes^2.
[[nodiscard]] QuantisedModes quantise(const Eigen::MatrixXf& modes, const Eigen::MatrixXd& rows, std::uint32_t planes);

/// The same with as few planes as keep the error within `most`, m. Throws std::runtime_error if none do.
[[nodiscard]] QuantisedModes quantise_within(const Eigen::MatrixXf& modes, const Eigen::MatrixXd& rows, double most);

}  // namespace greenloop::offline
