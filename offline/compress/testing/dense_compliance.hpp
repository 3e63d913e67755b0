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
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline::test {

using Sparse = Eigen::SparseMatrix<double>;

/// T_l as a matrix, 3 numbers per row of K(level), from the wavelet's odd nodes by the definition.
[[nodiscard]] Sparse forward_step(const SurfaceWavelet& wavelet, std::size_t level);

/// T_l^-1.
[[nodiscard]] Sparse backward_step(const SurfaceWavelet& wavelet, std::size_t level);

/// W on the rows of K(level), 3 numbers per row: T_1 .. T_level.
[[nodiscard]] Sparse forward_transform(const SurfaceWavelet& wavelet, std::size_t level);

/// [level] the exact compliance between the averages of that level, m/N.
[[nodiscard]] std::vector<Eigen::MatrixXd> level_compliances(const SurfaceWavelet& wavelet,
                                                             const Eigen::MatrixXd& compliance);

/// [level] what a model file stands for when cut off after that level, by dense products.
[[nodiscard]] std::vector<Eigen::MatrixXd> dense_compliances(const ModelView& view);

/// Hands out columns of a dense compliance, which must outlive it.
[[nodiscard]] ExactColumns columns_of(const Eigen::MatrixXd& compliance);

/// A body's model before encoding, its couplings coded from candidates down to a quarter of what `encoding` keeps.
[[nodiscard]] ModelData model_of(const Body& body, layout::Wavelet kind, const Encoding& encoding);

/// A verified model file.
struct File : ModelFile {
  explicit File(const ModelData& model);
};

/// Young's modulus, contacts and a rate.
[[nodiscard]] layout::Info facts();

}  // namespace greenloop::offline::test
