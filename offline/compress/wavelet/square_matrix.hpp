#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace greenloop::offline {

/// What couples two nodes or coefficients of N numbers each: N is 3 for vectors, 1 for scalars.
template <unsigned N>
using SquareMatrix = Eigen::Matrix<double, N, N>;

/// In single precision.
template <unsigned N>
using SquareMatrixF = Eigen::Matrix<float, N, N>;

/// Numbers of one.
template <unsigned N>
inline constexpr std::size_t block_numbers = std::size_t{N} * N;

/// Where the numbers of node i begin.
template <unsigned N>
[[nodiscard]] constexpr Eigen::Index block_begin(std::size_t i) {
  return static_cast<Eigen::Index>(N * i);
}

}  // namespace greenloop::offline
