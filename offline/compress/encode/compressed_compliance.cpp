#include "offline/compress/encode/compressed_compliance.hpp"

#include <algorithm>
#include <utility>

#include "formats/stored_blocks.hpp"
#include "offline/compress/wavelet/scale.hpp"

namespace greenloop::offline {
namespace {

// y += M f for every column; M: 9 numbers 3 c + r
void multiply(const float* m, bool transposed, std::size_t columns, const double* f, double* y) {
  for (std::size_t k = 0; k < columns; ++k, f += 3, y += 3) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) y[r] += static_cast<double>(transposed ? m[3 * r + c] : m[3 * c + r]) * f[c];
    }
  }
}

bool any(const double* f, std::size_t count) {
  return std::any_of(f, f + count, [](double x) { return x != 0; });
}

void append(const Eigen::Matrix3d& matrix, std::vector<float>& matrices) {
  for (int k = 0; k < 9; ++k) matrices.push_back(static_cast<float>(matrix.data()[k]));
}

Eigen::Matrix3d matrix(const std::vector<float>& matrices, std::size_t i) {
  return Eigen::Map<const Eigen::Matrix3f>(matrices.data() + 9 * i).cast<double>();
}

using RowBlocks = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A coefficient that forces on some nodes reach, and what all forces do to it. Weight: of a force on a node in the
// coefficient's, a number or a matrix.
template <class Weight>
class FeltCoefficient {
 public:
  FeltCoefficient(const double* weights, std::size_t nodes)
      : displacement_(RowBlocks::Zero(3, static_cast<Eigen::Index>(3 * nodes))) {
    constexpr std::size_t numbers = sizeof(Weight) / sizeof(double);
    for (std::size_t k = 0; k < nodes; ++k) {
      const double* const own = weights + numbers * k;
      if (any(own, numbers)) reach_.emplace_back(static_cast<Eigen::Index>(k), load(own, Weight()));
    }
  }

  // forces on `other` move this one by `block`
  void feel(const Eigen::Matrix3d& block, const FeltCoefficient& other) {
    for (const auto& [node, weight] : other.reach_) displacement_.template middleCols<3>(3 * node) += block * weight;
  }

  // adds what it moves its nodes by
  void move(const Eigen::Matrix3d& root, RowBlocks& nodes) const {
    const RowBlocks moved = root * displacement_;
    for (const auto& [node, weight] : reach_) nodes.middleRows<3>(3 * node) += transposed(weight) * moved;
  }

 private:
  static double load(const double* weight, double) { return *weight; }
  static Eigen::Matrix3d load(const double* weight, const Eigen::Matrix3d&) {
    return Eigen::Map<const Eigen::Matrix3d>(weight);
  }
  static double transposed(double weight) { return weight; }
  static Eigen::Matrix3d transposed(const Eigen::Matrix3d& weight) { return weight.transpose(); }

  std::vector<std::pair<Eigen::Index, Weight>> reach_;
  RowBlocks displacement_;
};

}  // namespace

CompressedCompliance::CompressedCompliance(const ModelView& view) : wavelet_(view) {
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& at = view.level[level];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      append(symmetric_matrix(at.scales_of<3>()[i].root), root_);
      append(symmetric_matrix(at.scales_of<3>()[i].diagonal), diagonal_);
    }
  }
  link(load_couplings(view));
}

std::vector<CompressedCompliance::Ends> CompressedCompliance::load_couplings(const ModelView& view) {
  std::vector<Ends> ends;
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = view.level[level].couplings[layer];
      for (std::uint32_t j = 0; j < couplings.columns; ++j) {
        for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          for (std::uint32_t k = 0; k < 9; ++k) {
            const std::int16_t value = stored_value<3>(couplings, layout::value_bits[layer], b, k);
            block_.push_back(view.info->quantum[layer] * static_cast<float>(value));
          }
          ends.emplace_back(stored_row(couplings, b), view.level[level].domain_begin + j);
        }
      }
    }
  }
  return ends;
}

void CompressedCompliance::link(const std::vector<Ends>& ends) {
  link_begin_.assign(wavelet_.rows() + 1, 0);
  for (const auto& [row, column] : ends) {
    ++link_begin_[row + 1];
    ++link_begin_[column + 1];
  }
  for (std::size_t i = 1; i < link_begin_.size(); ++i) link_begin_[i] += link_begin_[i - 1];
  links_.resize(2 * ends.size());
  auto next = link_begin_;
  for (std::uint32_t b = 0; b < ends.size(); ++b) {
    const auto& [row, column] = ends[b];
    links_[next[column]++] = {.other = row, .block = b, .transposed = false};
    links_[next[row]++] = {.other = column, .block = b, .transposed = true};
  }
}

void CompressedCompliance::apply(std::size_t level, std::size_t columns, const double* f, double* x) const {
  apply_to_coefficients(level, columns, f, x);
  for (std::size_t l = 1; l <= level; ++l) wavelet_.merge(l, 3 * columns, x);
}

void CompressedCompliance::apply_to_coefficients(std::size_t level, std::size_t columns, const double* f,
                                                 double* y) const {
  couple(level, level, columns, f, y);
}

void CompressedCompliance::displace(std::size_t level, std::size_t details, std::size_t columns, const double* f,
                                    double* x) const {
  std::fill_n(x, rows(finest()) * columns * 3, 0.0);
  couple(level, details, columns, f, x);
  for (std::size_t l = 1; l <= finest(); ++l) wavelet_.merge(l, 3 * columns, x);
}

// the coefficients of levels 0 .. to_level that forces on the averages of `level` move
void CompressedCompliance::couple(std::size_t level, std::size_t to_level, std::size_t columns, const double* f,
                                  double* y) const {
  const std::size_t width = 3 * columns, forced = rows(level), moved = rows(to_level);
  std::vector<double> force(f, f + forced * width);
  for (std::size_t l = level; l > 0; --l) wavelet_.split_forces(l, width, force.data());

  std::vector<double> sum(moved * width, 0.0);
  std::vector<double> scaled(width);
  for (std::size_t i = 0; i < forced; ++i) {
    const double* own = force.data() + i * width;
    if (!any(own, width)) continue;
    std::fill(scaled.begin(), scaled.end(), 0.0);
    multiply(root_.data() + 9 * i, false, columns, own, scaled.data());
    if (i < moved) multiply(diagonal_.data() + 9 * i, false, columns, scaled.data(), sum.data() + i * width);
    for (std::size_t at = link_begin_[i]; at < link_begin_[i + 1]; ++at) {
      const Link& link = links_[at];
      if (link.other >= moved) continue;
      multiply(block_.data() + std::size_t{9} * link.block, link.transposed, columns, scaled.data(),
               sum.data() + std::size_t{link.other} * width);
    }
  }

  std::fill_n(y, moved * width, 0.0);
  for (std::size_t i = 0; i < moved; ++i) {
    multiply(root_.data() + 9 * i, false, columns, sum.data() + i * width, y + i * width);
  }
}

Eigen::MatrixXd CompressedCompliance::between(std::size_t level, const std::vector<std::size_t>& nodes) const {
  return wavelet_.has_blocks() ? between<Eigen::Matrix3d>(level, nodes) : between<double>(level, nodes);
}

template <class Weight>
Eigen::MatrixXd CompressedCompliance::between(std::size_t level, const std::vector<std::size_t>& nodes) const {
  constexpr std::size_t numbers = sizeof(Weight) / sizeof(double);
  const std::size_t count = rows(level), width = numbers * nodes.size();
  std::vector<double> weights(count * width, 0.0);  // [coefficient][node]
  for (std::size_t k = 0; k < nodes.size(); ++k) {  // ones, or unit matrices
    for (std::size_t e = 0; e < numbers; e += 4) weights[width * nodes[k] + numbers * k + e] = 1;
  }
  for (std::size_t l = level; l > 0; --l) wavelet_.split_forces(l, width, weights.data());

  std::vector<FeltCoefficient<Weight>> felt;
  std::vector<std::size_t> place(count, count);  // in `felt`
  for (std::size_t i = 0; i < count; ++i) {
    if (!any(weights.data() + i * width, width)) continue;
    place[i] = felt.size();
    felt.emplace_back(weights.data() + i * width, nodes.size());
  }

  for (std::size_t i = 0; i < count; ++i) {
    if (place[i] == count) continue;
    const Eigen::Matrix3d root = matrix(root_, i);
    FeltCoefficient<Weight>& own = felt[place[i]];
    own.feel(matrix(diagonal_, i) * root, own);
    for (std::size_t at = link_begin_[i]; at < link_begin_[i + 1]; ++at) {
      const Link& link = links_[at];
      if (link.other >= count || place[link.other] == count) continue;
      const Eigen::Matrix3d block = matrix(block_, link.block);
      felt[place[link.other]].feel((link.transposed ? block.transpose() : block) * root, own);
    }
  }

  const auto size = static_cast<Eigen::Index>(3 * nodes.size());
  RowBlocks result = RowBlocks::Zero(size, size);
  for (std::size_t i = 0; i < count; ++i) {
    if (place[i] != count) felt[place[i]].move(matrix(root_, i), result);
  }
  return result;
}

std::vector<double> CompressedCompliance::column(std::size_t level, std::size_t j) const {
  std::vector<double> f(9 * rows(level), 0.0), x(9 * rows(level));
  for (std::size_t c = 0; c < 3; ++c) f[9 * j + 4 * c] = 1;
  apply(level, 3, f.data(), x.data());
  return x;
}

}  // namespace greenloop::offline
