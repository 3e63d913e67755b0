#include "offline/compress/wavelet/wavelet_compliance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/compress/wavelet/conditional_compliance.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t stream_columns = 64;  // columns read at a time

using Values = std::vector<double>;

// hands the exact columns over one by one, in order
template <unsigned N>
class ColumnReader {
 public:
  ColumnReader(const ExactColumns& source, std::size_t count) : source_(&source), count_(count) {}

  // rows x N N
  void next(Values& x) {
    if (at_ == first_ + held_) {
      first_ = at_;
      held_ = std::min(stream_columns, count_ - at_);
      block_ = (*source_)(first_, held_);
      if (block_.rows() != block_begin<N>(count_) || !block_.allFinite()) {
        throw std::invalid_argument("compression: exact columns " + std::to_string(first_) + " to " +
                                    std::to_string(first_ + held_ - 1) + " are not " + std::to_string(N * count_) +
                                    " finite numbers each");
      }
    }
    x.resize(block_numbers<N> * count_);
    const auto column = block_begin<N>(at_ - first_);
    for (std::size_t i = 0; i < count_; ++i) {
      Eigen::Map<SquareMatrix<N>>(x.data() + block_numbers<N> * i) = block_.block<N, N>(block_begin<N>(i), column);
    }
    ++at_;
  }

 private:
  const ExactColumns* source_;
  std::size_t count_, at_ = 0, first_ = 0, held_ = 0;
  Eigen::MatrixXd block_;
};

template <unsigned N>
SquareMatrix<N> block_of(const double* x, std::size_t row) {
  return Eigen::Map<const SquareMatrix<N>>(x + block_numbers<N> * row);
}

template <unsigned N>
SquareMatrix<N> symmetric(const SquareMatrix<N>& block) {
  return 0.5 * (block + block.transpose());
}

// x -= the prediction from the columns of even rows
template <class Column>
void predict(const SurfaceWavelet& wavelet, const SurfaceWavelet::Odd& odd, std::size_t count, Column column,
             double* x) {
  if (wavelet.has_blocks()) {
    for (const auto& [row, weight] : wavelet.block_prediction(odd)) {
      const float* from = column(row);
      const Eigen::Matrix3d right = weight.transpose();
      for (std::size_t k = 0; k < count; k += block_numbers<3>) {
        Eigen::Map<Eigen::Matrix3d>(x + k) -= Eigen::Map<const Eigen::Matrix3f>(from + k).cast<double>() * right;
      }
    }
    return;
  }
  for (const auto& [row, weight] : odd.prediction()) {
    const float* from = column(row);
    for (std::size_t k = 0; k < count; ++k) x[k] -= weight * static_cast<double>(from[k]);
  }
}

// the columns of the parents += their shares of the detail's
template <unsigned N>
void lift(const SurfaceWavelet::Odd& odd, const double* detail, BlockMatrix<N>& columns) {
  for (int side = 0; side < 2; ++side) {
    if (odd.lift[side] == 0) continue;
    float* to = columns.column(odd.parent[side]);
    const auto weight = static_cast<double>(odd.lift[side]);
    for (std::size_t k = 0; k < block_numbers<N> * columns.rows(); ++k) to[k] += static_cast<float>(weight * detail[k]);
  }
}

// V W^T in place, of levels `finest` and coarser
template <unsigned N>
void transform_columns(const SurfaceWavelet& wavelet, std::size_t finest, BlockMatrix<N>& matrix) {
  Values detail(block_numbers<N> * matrix.rows());
  for (std::size_t level = finest; level > 0; --level) {
    // predict all before any is lifted
    for (const auto& odd : wavelet.odds(level)) {
      float* own = matrix.column(odd.row);
      std::copy_n(own, detail.size(), detail.begin());
      predict(
          wavelet, odd, detail.size(), [&](std::uint32_t row) { return matrix.column(row); }, detail.data());
      std::transform(detail.begin(), detail.end(), own, [](double x) { return static_cast<float>(x); });
    }
    for (const auto& odd : wavelet.odds(level)) {
      std::copy_n(matrix.column(odd.row), detail.size(), detail.begin());
      lift(odd, detail.data(), matrix);
    }
  }
}

// the reciprocal of the least root of a diagonal block that is only known roughly
template <unsigned N>
double rough_inverse_root(const SquareMatrix<N>& block) {
  const Eigen::Matrix<double, N, 1> values =
      Eigen::SelfAdjointEigenSolver<SquareMatrix<N>>(symmetric<N>(block), Eigen::EigenvaluesOnly).eigenvalues();
  const double least = std::max(values.minCoeff(), 0.05 * values.cwiseAbs().sum() / N);
  return least > 0 ? 1 / std::sqrt(least) : 0;
}

template <unsigned N>
class Transform {
 public:
  Transform(const SurfaceWavelet& wavelet, double floor)
      : wavelet_(&wavelet), floor_(floor), rows_(wavelet.rows()), diagonal_(rows_), inverse_root_(rows_) {
    result_.couplings.resize(wavelet.finest() + 1);
  }

  [[nodiscard]] WaveletCompliance<N> run(const ExactColumns& columns, const Progress& progress) {
    const std::size_t finest = wavelet_->finest(), evens = finest > 0 ? wavelet_->row_end(finest - 1) : rows_;
    ColumnReader<N> reader(columns, rows_);
    Values x;
    for (std::size_t j = 0; j < rows_; ++j) {
      reader.next(x);
      for (std::size_t level = finest; level > 0; --level) wavelet_->split(level, block_numbers<N>, x.data());
      if (j < evens) even_columns_.emplace_back(x.begin(), x.end());
      if (j + 1 == evens) guess_scales(evens);
      if (j >= evens) add_finest_detail(wavelet_->odds(finest)[j - evens], x);
      if (progress && j % stream_columns == 0) {
        progress(0.9 * static_cast<double>(j) / static_cast<double>(rows_), "transform columns");
      }
    }
    add_coarse_columns(evens);
    scale();
    if (progress) progress(1.0, "transform columns");
    return std::move(result_);
  }

 private:
  void copy_evens(std::size_t evens) {
    for (std::size_t j = 0; j < evens; ++j) {
      std::copy_n(even_columns_[j].begin(), block_numbers<N> * evens, result_.coarse.column(j));
    }
  }

  // The scales of coarse coefficients are known exactly only when all details are lifted into them; the even columns
  // alone say enough to leave out what is far below the floor.
  void guess_scales(std::size_t evens) {
    const std::size_t finest = wavelet_->finest();
    result_.coarse = BlockMatrix<N>(evens);
    copy_evens(evens);
    if (finest == 0) return;
    transform_columns(*wavelet_, finest - 1, result_.coarse);
    for (std::size_t i = 0; i < evens; ++i) inverse_root_[i] = rough_inverse_root<N>(result_.coarse.block(i, i));
    copy_evens(evens);  // what details are lifted into
  }

  void add_finest_detail(const SurfaceWavelet::Odd& odd, Values& x) {
    predict(
        *wavelet_, odd, x.size(), [&](std::uint32_t row) { return even_columns_[row].data(); }, x.data());
    lift(odd, x.data(), result_.coarse);
    add_column(wavelet_->finest(), odd.row, [&](std::size_t i) { return block_of<N>(x.data(), i); });
  }

  void add_coarse_columns(std::size_t evens) {
    even_columns_ = {};
    const std::size_t finest = wavelet_->finest();
    if (finest > 0) transform_columns(*wavelet_, finest - 1, result_.coarse);
    std::size_t level = 0;
    for (std::size_t j = 0; j < evens; ++j) {
      while (j >= wavelet_->row_end(level)) ++level;
      add_column(level, j, [&](std::size_t i) { return result_.coarse.block(i, j); });
    }
  }

  // not scaled yet
  template <class Block>
  void add_column(std::size_t level, std::size_t j, Block block) {
    diagonal_[j] = symmetric<N>(block(j));
    inverse_root_[j] = rough_inverse_root<N>(diagonal_[j]);
    CouplingCandidates<N>& kept = result_.couplings[level];
    for (std::size_t i = 0; i < j; ++i) {
      const SquareMatrix<N> value = block(i);
      const double norm = value.norm() * inverse_root_[i] * inverse_root_[j];
      if (norm < floor_) continue;
      kept.row.push_back(static_cast<std::uint32_t>(i));
      for (std::size_t k = 0; k < block_numbers<N>; ++k) kept.value.push_back(static_cast<float>(value.data()[k]));
    }
    kept.begin.push_back(kept.row.size());
  }

  // by conditional compliances
  void scale() {
    const auto conditional = conditional_compliance<N>(diagonal_, result_.couplings);
    for (std::size_t i = 0; i < rows_; ++i) result_.scales.emplace_back(diagonal_[i], conditional[i], i);
    std::size_t column = 0;
    for (CouplingCandidates<N>& couplings : result_.couplings) {
      for (std::size_t j = 0; j + 1 < couplings.begin.size(); ++j, ++column) {
        for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          Eigen::Map<SquareMatrixF<N>> block(couplings.value.data() + block_numbers<N> * b);
          const SquareMatrix<N> scaled = result_.scales[couplings.row[b]].inverse() * block.template cast<double>() *
                                         result_.scales[column].inverse();
          block = scaled.template cast<float>();
          couplings.norm.push_back(static_cast<float>(scaled.norm() / std::sqrt(double{N})));
        }
      }
    }
  }

  const SurfaceWavelet* wavelet_;
  double floor_;
  std::size_t rows_;
  std::vector<std::vector<float>> even_columns_;  // transformed by rows, not by columns
  std::vector<SquareMatrix<N>> diagonal_;
  std::vector<double> inverse_root_;  // of the diagonal, the largest; a guess until the column is there
  WaveletCompliance<N> result_;
};

}  // namespace

template <unsigned N>
WaveletCompliance<N> transform_compliance(const SurfaceWavelet& wavelet, const ExactColumns& columns, double floor,
                                          const Progress& progress) {
  if (N != 3 && wavelet.has_blocks()) {
    throw std::invalid_argument("compression: 3x3 weights do not predict " + std::to_string(N) + " number a node");
  }
  return Transform<N>(wavelet, floor).run(columns, progress);
}

template <unsigned N>
std::vector<double> exact_column(const SurfaceWavelet& wavelet, const WaveletCompliance<N>& compliance,
                                 std::size_t level, std::size_t j) {
  const std::size_t size = block_numbers<N> * wavelet.row_end(level);
  Values f(size, 0.0), x(size, 0.0);
  for (std::size_t c = 0; c < N; ++c) f[block_numbers<N> * j + (N + 1) * c] = 1;
  for (std::size_t l = level; l > 0; --l) wavelet.split_forces(l, block_numbers<N>, f.data());
  for (std::size_t i = 0; i < wavelet.row_end(level); ++i) {
    const SquareMatrix<N> force = block_of<N>(f.data(), i);
    if (force.isZero(0)) continue;
    for (std::size_t row = 0; row < wavelet.row_end(level); ++row) {
      Eigen::Map<SquareMatrix<N>>(x.data() + block_numbers<N> * row) += compliance.coarse.block(row, i) * force;
    }
  }
  for (std::size_t l = 1; l <= level; ++l) wavelet.merge(l, block_numbers<N>, x.data());
  return x;
}

template WaveletCompliance<1> transform_compliance(const SurfaceWavelet&, const ExactColumns&, double, const Progress&);
template WaveletCompliance<3> transform_compliance(const SurfaceWavelet&, const ExactColumns&, double, const Progress&);

template std::vector<double> exact_column(const SurfaceWavelet&, const WaveletCompliance<1>&, std::size_t, std::size_t);
template std::vector<double> exact_column(const SurfaceWavelet&, const WaveletCompliance<3>&, std::size_t, std::size_t);

}  // namespace greenloop::offline
