#include "offline/figures/column_form.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/figures/column_compression.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 9;
constexpr std::size_t stream_columns = 64;  // read at a time

using Values = std::vector<double>;

// Errors and blocks of all columns of a level, for every threshold.
class ColumnSums {
 public:
  explicit ColumnSums(std::size_t thresholds) : sums_(thresholds) {}

  void add(const CompressedColumn& column) {
    exact_energy_ += column.exact_energy;
    ++columns_;
    for (std::size_t t = 0; t < sums_.size(); ++t) {
      sums_[t].kept += column.trials[t].kept;
      sums_[t].error_energy += column.trials[t].error_energy;
      sums_[t].worst = std::max(sums_[t].worst, column.trials[t].worst);
    }
  }

  [[nodiscard]] LevelRates rates(std::size_t level, std::size_t rows, const std::vector<double>& thresholds) const {
    LevelRates result{.level = level, .columns = columns_, .points = {}};
    const auto dense = static_cast<double>(columns_ * rows);
    for (std::size_t t = 0; t < sums_.size(); ++t) {
      RatePoint point;
      point.threshold = thresholds[t];
      point.ratio = dense / static_cast<double>(sums_[t].kept);
      point.rms = std::sqrt(sums_[t].error_energy / exact_energy_);
      point.worst_column = sums_[t].worst;
      result.points.push_back(point);
    }
    return result;
  }

 private:
  std::vector<ColumnTrial> sums_;  // [threshold]
  double exact_energy_ = 0;
  std::size_t columns_ = 0;
};

// Green's functions of a coarse level's scaling functions, summed from the columns of nodes.
class CoarseColumns {
 public:
  CoarseColumns(const SurfaceWavelet& wavelet, std::size_t level) : count_(wavelet.row_end(level)) {
    values_.resize(count_, std::vector<float>(width * wavelet.rows(), 0.0F));
    scaling_.assign(wavelet.rows() * count_, 0.0);
    for (std::size_t k = 0; k < count_; ++k) scaling_[k * count_ + k] = 1;
    for (std::size_t l = level + 1; l <= wavelet.finest(); ++l) wavelet.merge(l, count_, scaling_.data());
  }

  void add(std::size_t node, const Values& x) {
    for (std::size_t k = 0; k < count_; ++k) {
      const double weight = scaling_[node * count_ + k];
      if (weight == 0) continue;
      for (std::size_t i = 0; i < x.size(); ++i) values_[k][i] += static_cast<float>(weight * x[i]);
    }
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] Values column(std::size_t k) const { return {values_[k].begin(), values_[k].end()}; }

 private:
  std::size_t count_;
  Values scaling_;  // [row][scaling function] its value there
  std::vector<std::vector<float>> values_;
};

// The finest level's compressed patches beside the exact ones.
class PatchForces {
 public:
  PatchForces(const std::vector<Eigen::Vector3d>& positions, std::size_t thresholds)
      : exact_(positions, figure_patches), found_(thresholds, exact_), rows_(exact_.rows()) {}

  [[nodiscard]] bool touch(std::size_t j) const { return std::binary_search(rows_.begin(), rows_.end(), j); }
  void add_exact(std::size_t j, const Values& x, double area) { exact_.add(block(x, area), j); }
  void add(std::size_t threshold, std::size_t j, const Values& x, double area) {
    found_[threshold].add(block(x, area), j);
  }
  [[nodiscard]] double worst_error(std::size_t threshold) const { return exact_.worst_force_error(found_[threshold]); }

 private:
  static Eigen::MatrixXd block(const Values& x, double area) {
    Eigen::MatrixXd columns(x.size() / 3, 3);
    for (std::size_t i = 0; i < x.size() / width; ++i) {
      columns.middleRows<3>(static_cast<Eigen::Index>(3 * i)) =
          Eigen::Map<const Eigen::Matrix3d>(x.data() + width * i) / area;
    }
    return columns;
  }

  ContactPatches exact_;
  std::vector<ContactPatches> found_;  // [threshold]
  std::vector<std::size_t> rows_;
};

Values scaled(Values values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

class ColumnFormStudy {
 public:
  ColumnFormStudy(const ExactBody& body, const WaveletKind& kind, const std::vector<double>& thresholds)
      : body_(body),
        wavelet_(body.mesh, body.flags, body.area, kind.wavelet),
        thresholds_(thresholds),
        patches_(row_positions(body.mesh, wavelet_, wavelet_.finest()), thresholds.size()),
        compression_(wavelet_, thresholds),
        finest_(thresholds.size()) {
    for (std::size_t level = 0; level < wavelet_.finest(); ++level) coarse_.emplace_back(wavelet_, level);
  }

  [[nodiscard]] std::vector<LevelRates> run(const Progress& progress) {
    const std::size_t rows = wavelet_.rows();
    for (std::size_t first = 0; first < rows; first += stream_columns) {
      const std::size_t count = std::min(stream_columns, rows - first);
      const Eigen::MatrixXd block = body_.columns(first, count);
      for (std::size_t j = 0; j < count; ++j) add(first + j, blocks_of(block, j));
      if (progress) progress(static_cast<double>(first + count) / static_cast<double>(rows), "one-sided columns");
    }
    return rates();
  }

 private:
  void add(std::size_t j, const Values& column) {
    const double area = body_.area[wavelet_.nodes()[j]];
    const Values x = scaled(column, area);
    for (CoarseColumns& level : coarse_) level.add(j, x);
    const bool in_patch = patches_.touch(j);
    if (in_patch) patches_.add_exact(j, x, area);
    finest_.add(compression_.compress(x, [&](std::size_t threshold, const Values& error) {
      if (!in_patch) return;
      Values found = x;
      for (std::size_t i = 0; i < x.size(); ++i) found[i] -= error[i];
      patches_.add(threshold, j, found, area);
    }));
  }

  [[nodiscard]] std::vector<LevelRates> rates() const {
    std::vector<LevelRates> levels;
    for (std::size_t level = 0; level < coarse_.size(); ++level) {
      ColumnSums sums(thresholds_.size());
      for (std::size_t k = 0; k < coarse_[level].size(); ++k) {
        sums.add(compression_.compress(coarse_[level].column(k)));
      }
      levels.push_back(sums.rates(level, wavelet_.rows(), thresholds_));
    }
    levels.push_back(finest_.rates(wavelet_.finest(), wavelet_.rows(), thresholds_));
    for (std::size_t t = 0; t < thresholds_.size(); ++t) levels.back().points[t].patch_force = patches_.worst_error(t);
    return levels;
  }

  const ExactBody& body_;
  SurfaceWavelet wavelet_;
  const std::vector<double>& thresholds_;
  PatchForces patches_;
  ColumnCompression compression_;
  ColumnSums finest_;
  std::vector<CoarseColumns> coarse_;
};

}  // namespace

std::vector<LevelRates> column_form_rates(const ExactBody& body, const WaveletKind& kind,
                                          const std::vector<double>& thresholds, const Progress& progress) {
  return ColumnFormStudy(body, kind, thresholds).run(progress);
}

}  // namespace greenloop::offline
