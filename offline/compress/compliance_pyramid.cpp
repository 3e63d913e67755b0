#include "offline/compress/compliance_pyramid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/layout.hpp"
#include "offline/compress/conditional_compliance.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;
constexpr std::size_t stream_columns = 64;  // columns read at a time

using Values = std::vector<double>;

// hands the columns of a level's compliance over one by one, in order
class ColumnReader {
 public:
  ColumnReader(const ColumnSource& source, std::size_t count) : source_(&source), count_(count) {}

  // rows x 9
  void next(Values& x) {
    if (at_ == first_ + held_) {
      first_ = at_;
      held_ = std::min(stream_columns, count_ - at_);
      block_ = (*source_)(first_, held_);
      if (block_.rows() != static_cast<Eigen::Index>(3 * count_) || !block_.allFinite()) {
        throw std::invalid_argument("compression: exact columns " + std::to_string(first_) + " to " +
                                    std::to_string(first_ + held_ - 1) + " are not " + std::to_string(3 * count_) +
                                    " finite numbers each");
      }
    }
    x.resize(width * count_);
    const auto column = static_cast<Eigen::Index>(3 * (at_ - first_));
    for (std::size_t i = 0; i < count_; ++i) {
      Eigen::Map<Eigen::Matrix3d>(x.data() + width * i) = block_.block<3, 3>(static_cast<Eigen::Index>(3 * i), column);
    }
    ++at_;
  }

 private:
  const ColumnSource* source_;
  std::size_t count_, at_ = 0, first_ = 0, held_ = 0;
  Eigen::MatrixXd block_;
};

Eigen::Matrix3d block_of(const double* x, std::size_t row) {
  return Eigen::Map<const Eigen::Matrix3d>(x + width * row);
}

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& block) { return 0.5 * (block + block.transpose()); }

void add(double weight, const double* from, std::size_t count, float* to) {
  for (std::size_t k = 0; k < count; ++k) to[k] += static_cast<float>(weight * from[k]);
}

void subtract_half(const float* from, Values& x) {
  for (std::size_t k = 0; k < x.size(); ++k) x[k] -= 0.5 * static_cast<double>(from[k]);
}

// the reciprocal of the least root of a diagonal block that is only known roughly
double rough_inverse_root(const Eigen::Matrix3d& block) {
  const Eigen::Vector3d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric(block), Eigen::EigenvaluesOnly).eigenvalues();
  const double least = std::max(values.minCoeff(), 0.05 * values.cwiseAbs().sum() / 3);
  return least > 0 ? 1 / std::sqrt(least) : 0;
}

// block (i, j) becomes rows[i] block columns[j]^T
void rescale(CouplingCandidates& couplings, const std::vector<Eigen::Matrix3d>& rows,
             const std::vector<Eigen::Matrix3d>& columns) {
  for (std::size_t j = 0; j + 1 < couplings.begin.size(); ++j) {
    for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
      Eigen::Map<Eigen::Matrix3f> block(couplings.value.data() + width * b);
      const Eigen::Matrix3d scaled = rows[couplings.row[b]] * block.cast<double>() * columns[j].transpose();
      block = scaled.cast<float>();
      couplings.norm[b] = static_cast<float>(scaled.norm() / std::sqrt(3.0));
    }
  }
}

// One level of the pyramid while its columns stream by.
class LevelReduction {
 public:
  LevelReduction(const LinearWavelet& wavelet, std::size_t level, double floor)
      : wavelet_(&wavelet),
        level_(level),
        rows_(wavelet.row_end(level)),
        evens_(wavelet.row_end(level - 1)),
        floor_(floor),
        even_columns_(evens_),
        lifted_(evens_) {}

  void add_even(std::size_t j, Values& x) {
    wavelet_->split(level_, width, x.data());
    even_columns_[j].assign(x.begin(), x.end());
    if (j + 1 == evens_) guess_partner_scales();
  }

  void add_odd(const LinearWavelet::Odd& odd, Values& x) {
    wavelet_->split(level_, width, x.data());
    for (const std::uint32_t parent : odd.parent) {
      if (parent != LinearWavelet::no_row) subtract_half(even_columns_[parent].data(), x);
    }
    for (int side = 0; side < 2; ++side) {
      if (odd.lift[side] != 0) {
        add(static_cast<double>(odd.lift[side]), x.data(), width * evens_, lifted_.column(odd.parent[side]));
      }
    }
    keep_details(odd.row, x);
    if (level_ > 1) wavelet_->split(level_ - 1, width, x.data());
    keep_partners(x);
  }

  // the compliance between the averages of the next coarser level
  [[nodiscard]] DenseCompliance averages() {
    for (std::size_t j = 0; j < evens_; ++j) {
      float* column = lifted_.column(j);
      for (std::size_t k = 0; k < width * evens_; ++k) column[k] += even_columns_[j][k];
    }
    for (std::size_t j = 0; j < evens_; ++j) {
      for (std::size_t i = 0; i <= j; ++i) symmetrize(i, j);
    }
    return std::move(lifted_);
  }

  // rescaled by conditional compliances; couplings with partners are not scaled yet
  [[nodiscard]] CompliancePyramid::Level result() {
    auto& same = result_.partner[static_cast<int>(layout::Partner::same)];
    const auto conditional = conditional_compliance(diagonal_, same);
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
      result_.details.emplace_back(diagonal_[i], conditional[i], "detail", i);
    }
    std::vector<Eigen::Matrix3d> change;
    change.reserve(diagonal_.size());
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
      change.push_back(result_.details[i].inverse() * own_scales_[i].root());
    }
    rescale(same, change, change);
    return std::move(result_);
  }

 private:
  void symmetrize(std::size_t i, std::size_t j) {
    const Eigen::Matrix3f mean = (0.5 * (lifted_.block(i, j) + lifted_.block(j, i).transpose())).cast<float>();
    Eigen::Map<Eigen::Matrix3f>(lifted_.column(j) + width * i) = mean;
    Eigen::Map<Eigen::Matrix3f>(lifted_.column(i) + width * j) = mean.transpose();
  }

  // Scales of the partners are known exactly only when the coarser levels are; the unlifted even columns say enough to
  // leave out what is far below the floor.
  void guess_partner_scales() {
    const std::size_t averages = level_ > 1 ? wavelet_->row_end(level_ - 2) : evens_;
    guess_.resize(evens_);
    Values x(width * evens_);
    for (std::size_t j = 0; j < evens_; ++j) {
      std::copy_n(even_columns_[j].begin(), x.size(), x.begin());
      if (j >= averages) {
        for (const std::uint32_t parent : wavelet_->odds(level_ - 1)[j - averages].parent) {
          if (parent != LinearWavelet::no_row) subtract_half(even_columns_[parent].data(), x);
        }
      }
      if (level_ > 1) wavelet_->split(level_ - 1, width, x.data());
      guess_[j] = rough_inverse_root(block_of(x.data(), j));
    }
  }

  void keep_details(std::size_t row, const Values& x) {
    const std::size_t own = row - evens_;
    const Eigen::Matrix3d diagonal = symmetric(block_of(x.data(), row));
    const CoefficientScale scale(diagonal, diagonal, "detail", row);
    auto& kept = result_.partner[static_cast<int>(layout::Partner::same)];
    kept.rows = rows_ - evens_;
    for (std::size_t i = 0; i < own; ++i) {
      const Eigen::Matrix3d scaled = own_scales_[i].inverse() * block_of(x.data(), evens_ + i) * scale.inverse();
      append(kept, i, scaled, scaled.norm() / std::sqrt(3.0));
    }
    kept.begin.push_back(kept.row.size());
    diagonal_.push_back(diagonal);
    own_scales_.push_back(scale);
  }

  void keep_partners(const Values& x) {
    const std::size_t averages = level_ > 1 ? wavelet_->row_end(level_ - 2) : evens_;
    const double own = own_scales_.back().inverse().norm();
    for (std::size_t row = 0; row < evens_; ++row) {
      const bool is_average = row < averages;
      auto& kept = result_.partner[static_cast<int>(is_average ? layout::Partner::averages : layout::Partner::parents)];
      const Eigen::Matrix3d block = block_of(x.data(), row);
      append(kept, is_average ? row : row - averages, block, block.norm() * own * guess_[row]);
    }
    for (auto* kept : {&result_.partner[0], &result_.partner[1]}) kept->begin.push_back(kept->row.size());
    result_.partner[0].rows = averages;
    result_.partner[1].rows = evens_ - averages;
  }

  void append(CouplingCandidates& kept, std::size_t row, const Eigen::Matrix3d& block, double norm) const {
    if (norm < floor_) return;
    kept.row.push_back(static_cast<std::uint32_t>(row));
    kept.norm.push_back(static_cast<float>(norm));
    for (int k = 0; k < 9; ++k) kept.value.push_back(static_cast<float>(block.data()[k]));
  }

  const LinearWavelet* wavelet_;
  std::size_t level_, rows_, evens_;
  double floor_;
  std::vector<std::vector<float>> even_columns_;  // split by rows, unlifted by columns
  DenseCompliance lifted_;                        // what lifting adds to them
  std::vector<double> guess_;                     // of each partner's largest inverse root
  std::vector<Eigen::Matrix3d> diagonal_;
  std::vector<CoefficientScale> own_scales_;  // by the diagonal blocks alone
  CompliancePyramid::Level result_;
};

std::vector<Eigen::Matrix3d> inverse_roots(const std::vector<CoefficientScale>& scales) {
  std::vector<Eigen::Matrix3d> inverses;
  inverses.reserve(scales.size());
  for (const auto& scale : scales) inverses.push_back(scale.inverse());
  return inverses;
}

std::vector<CoefficientScale> average_scales(const DenseCompliance& compliance) {
  const auto conditional = conditional_compliance(compliance);
  std::vector<CoefficientScale> scales;
  scales.reserve(compliance.rows());
  for (std::size_t i = 0; i < compliance.rows(); ++i) {
    scales.emplace_back(compliance.block(i, i), conditional[i], "average", i);
  }
  return scales;
}

// level 0 couples all averages with each other
CompliancePyramid::Level base_level(const DenseCompliance& compliance) {
  CompliancePyramid::Level base;
  base.averages = average_scales(compliance);
  auto& kept = base.partner[static_cast<int>(layout::Partner::same)];
  kept.rows = compliance.rows();
  for (std::size_t j = 0; j < compliance.rows(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const Eigen::Matrix3d block = base.averages[i].inverse() * compliance.block(i, j) * base.averages[j].inverse();
      kept.row.push_back(static_cast<std::uint32_t>(i));
      kept.norm.push_back(static_cast<float>(block.norm() / std::sqrt(3.0)));
      for (int k = 0; k < 9; ++k) kept.value.push_back(static_cast<float>(block.data()[k]));
    }
    kept.begin.push_back(kept.row.size());
  }
  return base;
}

ColumnSource read_dense(const DenseCompliance& compliance) {
  return [&compliance](std::size_t first, std::size_t count) {
    Eigen::MatrixXd block(3 * compliance.rows(), 3 * count);
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t i = 0; i < compliance.rows(); ++i) {
        block.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
            compliance.block(i, first + j);
      }
    }
    return block;
  };
}

DenseCompliance read_all(const ColumnSource& columns, std::size_t rows) {
  DenseCompliance compliance(rows);
  ColumnReader reader(columns, rows);
  Values x;
  for (std::size_t j = 0; j < rows; ++j) {
    reader.next(x);
    std::copy(x.begin(), x.end(), compliance.column(j));
  }
  return compliance;
}

}  // namespace

CompliancePyramid build_pyramid(const LinearWavelet& wavelet, const ColumnSource& columns, double floor,
                                const Progress& progress) {
  const std::size_t finest = wavelet.finest();
  CompliancePyramid pyramid;
  pyramid.levels.resize(finest + 1);
  ColumnSource source = columns;
  std::vector<DenseCompliance> fine_to_coarse;
  fine_to_coarse.reserve(finest + 1);  // sources refer to them
  for (std::size_t level = finest; level > 0; --level) {
    const std::size_t rows = wavelet.row_end(level), evens = wavelet.row_end(level - 1);
    LevelReduction reduction(wavelet, level, floor);
    ColumnReader reader(source, rows);
    Values x;
    for (std::size_t j = 0; j < rows; ++j) {
      reader.next(x);
      if (j < evens) {
        reduction.add_even(j, x);
      } else {
        reduction.add_odd(wavelet.odds(level)[j - evens], x);
      }
      if (progress && level == finest && j % stream_columns == 0) {
        progress(0.9 * static_cast<double>(j) / static_cast<double>(rows), "transform columns");
      }
    }
    pyramid.levels[level] = reduction.result();
    fine_to_coarse.push_back(reduction.averages());
    source = read_dense(fine_to_coarse.back());
  }
  if (finest == 0) fine_to_coarse.push_back(read_all(columns, wavelet.rows()));

  for (auto it = fine_to_coarse.rbegin(); it != fine_to_coarse.rend(); ++it) pyramid.coarse.push_back(std::move(*it));
  pyramid.levels[0] = base_level(pyramid.coarse[0]);
  for (std::size_t level = 1; level + 2 <= finest; ++level) {
    pyramid.levels[level].averages = average_scales(pyramid.coarse[level]);
  }
  for (std::size_t level = 1; level <= finest; ++level) {
    auto& own = pyramid.levels[level];
    const auto own_inverses = inverse_roots(own.details);
    rescale(own.partner[0], inverse_roots(pyramid.levels[level > 2 ? level - 2 : 0].averages), own_inverses);
    if (level > 1) rescale(own.partner[1], inverse_roots(pyramid.levels[level - 1].details), own_inverses);
  }
  if (progress) progress(1.0, "transform columns");
  return pyramid;
}

}  // namespace greenloop::offline
