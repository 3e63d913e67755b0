#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/encode/coupling_coder.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/compress/wavelet/exact_columns.hpp"
#include "offline/compress/wavelet/square_matrix.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline::test {

using Sparse = Eigen::SparseMatrix<double>;

// N: numbers of a node, 3 or 1.

/// A row and its weight in a prediction.
template <unsigned N>
struct PredictionTerm {
  std::uint32_t row;
  SquareMatrix<N> weight;
};

/// What predicts an odd node, whatever the kind: numbers weigh all components alike.
template <unsigned N = 3>
[[nodiscard]] std::vector<PredictionTerm<N>> prediction_of(const SurfaceWavelet& wavelet,
                                                           const SurfaceWavelet::Odd& odd);

/// T_l as a matrix, N numbers per row of K(level), from the wavelet's odd nodes by the definition.
template <unsigned N = 3>
[[nodiscard]] Sparse forward_step(const SurfaceWavelet& wavelet, std::size_t level);

/// T_l^-1.
template <unsigned N = 3>
[[nodiscard]] Sparse backward_step(const SurfaceWavelet& wavelet, std::size_t level);

/// W on the rows of K(level), N numbers per row: T_1 .. T_level.
template <unsigned N = 3>
[[nodiscard]] Sparse forward_transform(const SurfaceWavelet& wavelet, std::size_t level);

/// [level] the exact compliance between the averages of that level, m/N.
template <unsigned N = 3>
[[nodiscard]] std::vector<Eigen::MatrixXd> level_compliances(const SurfaceWavelet& wavelet,
                                                             const Eigen::MatrixXd& compliance);

/// [level] what a model file stands for when cut off after that level, by dense products.
[[nodiscard]] std::vector<Eigen::MatrixXd> dense_compliances(const ModelView& view);

/// Hands out columns of a dense compliance, which must outlive it.
template <unsigned N = 3>
[[nodiscard]] ExactColumns columns_of(const Eigen::MatrixXd& compliance);

/// A body's model before encoding, its couplings coded from candidates down to a quarter of what `encoding` keeps.
template <unsigned N = 3>
[[nodiscard]] ModelData model_of(const Body& body, layout::Wavelet kind, const Encoding& encoding);

/// A verified model file.
struct File : ModelFile {
  explicit File(const ModelData& model);
};

/// Young's modulus and Poisson's ratio of vectors, contacts and a rate.
template <unsigned N = 3>
[[nodiscard]] layout::Info facts();

}  // namespace greenloop::offline::test
