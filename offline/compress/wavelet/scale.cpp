#include "offline/compress/wavelet/scale.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

template <unsigned N>
void store(const SquareMatrix<N>& symmetric, float (&numbers)[N * (N + 1) / 2]) {
  constexpr int size = N;
  int k = 0;
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < size; ++j) numbers[k++] = static_cast<float>(symmetric(i, j));
  }
}

// to multiples of the next power of two below `step`, zeros without a sign
template <unsigned N>
SquareMatrix<N> rounded(const SquareMatrix<N>& matrix, double step) {
  const double unit = std::exp2(std::floor(std::log2(step)));
  return unit * ((matrix / unit).array().round() + 0.0).matrix();
}

}  // namespace

template <unsigned N>
CoefficientScale<N>::CoefficientScale(const SquareMatrix<N>& diagonal, const SquareMatrix<N>& conditional,
                                      std::size_t coefficient) {
  const Eigen::SelfAdjointEigenSolver<SquareMatrix<N>> solver(conditional);
  if (!(solver.eigenvalues().minCoeff() > 0)) {
    throw std::invalid_argument("compression: the compliance is not positive definite: wavelet coefficient " +
                                std::to_string(coefficient) + " has the conditional compliance " +
                                std::to_string(solver.eigenvalues().minCoeff()) +
                                " m/N; are the exact columns those of an elastic body?");
  }
  root_ = solver.operatorSqrt();
  inverse_ = solver.operatorInverseSqrt();
  diagonal_ = inverse_ * diagonal * inverse_;
}

template <unsigned N>
layout::Scale<N> CoefficientScale<N>::stored(double quantum) const {
  constexpr double root_share = 0x1p-18;   // of the least eigenvalue
  constexpr double diagonal_share = 0.25;  // of the quantum
  const double least = 1 / inverse_.norm();
  layout::Scale<N> scale{};
  store<N>(rounded<N>(root_, root_share * least), scale.root);
  store<N>(rounded<N>(0.5 * (diagonal_ + diagonal_.transpose()), diagonal_share * quantum), scale.diagonal);
  return scale;
}

template class CoefficientScale<1>;
template class CoefficientScale<3>;

SquareMatrix<3> symmetric_matrix(const float (&six)[6]) {
  Eigen::Matrix3f matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix.cast<double>();
}

SquareMatrix<1> symmetric_matrix(const float (&one)[1]) { return SquareMatrix<1>(static_cast<double>(one[0])); }

}  // namespace greenloop::offline
