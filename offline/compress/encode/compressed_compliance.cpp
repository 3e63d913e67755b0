#include "offline/compress/encode/compressed_compliance.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/stored_blocks.hpp"
#include "offline/compress/wavelet/scale.hpp"

namespace greenloop::offline {
namespace {

// y += M f for every column
template <unsigned N>
void multiply(const SquareMatrixF<N>& matrix, std::size_t columns, const double* f, double* y) {
  const SquareMatrix<N> m = matrix.template cast<double>();
  for (std::size_t k = 0; k < columns; ++k, f += N, y += N) {
    Eigen::Map<Eigen::Matrix<double, N, 1>> sum(y);
    for (unsigned c = 0; c < N; ++c) sum += m.col(c) * f[c];
  }
}

bool any(const double* f, std::size_t count) {
  return std::any_of(f, f + count, [](double x) { return x != 0; });
}

using RowBlocks = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// of the weight of a force on a node in that on a coefficient: a number or a matrix
template <class Weight>
constexpr std::size_t weight_numbers = Weight::SizeAtCompileTime;
template <>
constexpr std::size_t weight_numbers<double> = 1;

// A coefficient that forces on some nodes reach, and what all forces do to it.
template <unsigned N, class Weight>
class FeltCoefficient {
 public:
  FeltCoefficient(const double* weights, std::size_t nodes) : displacement_(nodes, SquareMatrix<N>::Zero()) {
    constexpr std::size_t numbers = weight_numbers<Weight>;
    for (std::size_t k = 0; k < nodes; ++k) {
      const double* const own = weights + numbers * k;
      if (any(own, numbers)) reach_.emplace_back(k, load(own, Weight()));
    }
  }

  // forces on `other` move this one by `block`
  void feel(const SquareMatrix<N>& block, const FeltCoefficient& other) {
    for (const auto& [node, weight] : other.reach_) displacement_[node] += block * weight;
  }

  // adds what it moves its nodes by
  void move(const SquareMatrix<N>& root, RowBlocks& nodes) const {
    RowBlocks displacement(N, nodes.cols());
    for (std::size_t k = 0; k < displacement_.size(); ++k) {
      displacement.middleCols<N>(block_begin<N>(k)) = displacement_[k];
    }
    const RowBlocks moved = root * displacement;
    for (const auto& [node, weight] : reach_) {
      nodes.middleRows<N>(block_begin<N>(node)) += transposed(weight) * moved;
    }
  }

 private:
  static double load(const double* weight, double) { return *weight; }
  static SquareMatrix<N> load(const double* weight, const SquareMatrix<N>&) {
    return Eigen::Map<const SquareMatrix<N>>(weight);
  }
  static double transposed(double weight) { return weight; }
  static SquareMatrix<N> transposed(const SquareMatrix<N>& weight) { return weight.transpose(); }

  std::vector<std::pair<std::size_t, Weight>> reach_;
  std::vector<SquareMatrix<N>> displacement_;  // by node
};

// a view of a model whose components are N
template <unsigned N>
const ModelView& checked(const ModelView& view) {
  if (view.info->components != N) {
    throw std::invalid_argument("compression: the model has " + std::to_string(view.info->components) +
                                " numbers a node, not " + std::to_string(N));
  }
  return view;
}

// calls visit(row, column, its block) for every coupling
template <unsigned N, class Visit>
void visit_couplings(const ModelView& view, Visit visit) {
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = view.level[level].couplings[layer];
      for (std::uint32_t j = 0; j < couplings.columns; ++j) {
        for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          SquareMatrixF<N> block;
          for (std::uint32_t k = 0; k < N * N; ++k) {
            const std::int16_t value = stored_value<N>(couplings, layout::value_bits[layer], b, k);
            block.data()[k] = view.info->quantum[layer] * static_cast<float>(value);
          }
          visit(stored_row(couplings, b), view.level[level].domain_begin + j, block);
        }
      }
    }
  }
}

}  // namespace

template <unsigned N>
CompressedCompliance<N>::CompressedCompliance(const ModelView& view) : wavelet_(checked<N>(view)) {
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& at = view.level[level];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      root_.push_back(symmetric_matrix(at.scales_of<N>()[i].root).template cast<float>());
      diagonal_.push_back(symmetric_matrix(at.scales_of<N>()[i].diagonal).template cast<float>());
    }
  }
  link(view);
}

template <unsigned N>
void CompressedCompliance<N>::link(const ModelView& view) {
  link_begin_.assign(wavelet_.rows() + 1, 0);
  visit_couplings<N>(view, [&](std::uint32_t row, std::uint32_t column, const SquareMatrixF<N>&) {
    ++link_begin_[row + 1];
    ++link_begin_[column + 1];
  });
  for (std::size_t i = 1; i < link_begin_.size(); ++i) link_begin_[i] += link_begin_[i - 1];
  links_.resize(link_begin_.back());
  auto next = link_begin_;
  visit_couplings<N>(view, [&](std::uint32_t row, std::uint32_t column, const SquareMatrixF<N>& block) {
    links_[next[column]++] = {.other = row, .block = block};
    links_[next[row]++] = {.other = column, .block = block.transpose()};
  });
}

template <unsigned N>
void CompressedCompliance<N>::apply(std::size_t level, std::size_t columns, const double* f, double* x) const {
  apply_to_coefficients(level, columns, f, x);
  for (std::size_t l = 1; l <= level; ++l) wavelet_.merge(l, N * columns, x);
}

template <unsigned N>
void CompressedCompliance<N>::apply_to_coefficients(std::size_t level, std::size_t columns, const double* f,
                                                    double* y) const {
  couple(level, level, columns, f, y);
}

template <unsigned N>
void CompressedCompliance<N>::displace(std::size_t level, std::size_t details, std::size_t columns, const double* f,
                                       double* x) const {
  std::fill_n(x, rows(finest()) * columns * N, 0.0);
  couple(level, details, columns, f, x);
  for (std::size_t l = 1; l <= finest(); ++l) wavelet_.merge(l, N * columns, x);
}

// the coefficients of levels 0 .. to_level that forces on the averages of `level` move
template <unsigned N>
void CompressedCompliance<N>::couple(std::size_t level, std::size_t to_level, std::size_t columns, const double* f,
                                     double* y) const {
  const std::size_t width = N * columns, forced = rows(level), moved = rows(to_level);
  std::vector<double> force(f, f + forced * width);
  for (std::size_t l = level; l > 0; --l) wavelet_.split_forces(l, width, force.data());

  std::vector<double> sum(moved * width, 0.0);
  std::vector<double> scaled(width);
  for (std::size_t i = 0; i < forced; ++i) {
    const double* own = force.data() + i * width;
    if (!any(own, width)) continue;
    std::fill(scaled.begin(), scaled.end(), 0.0);
    multiply<N>(root_[i], columns, own, scaled.data());
    if (i < moved) multiply<N>(diagonal_[i], columns, scaled.data(), sum.data() + i * width);
    for (std::size_t at = link_begin_[i]; at < link_begin_[i + 1]; ++at) {
      const auto& [other, block] = links_[at];
      if (other < moved) multiply<N>(block, columns, scaled.data(), sum.data() + std::size_t{other} * width);
    }
  }

  std::fill_n(y, moved * width, 0.0);
  for (std::size_t i = 0; i < moved; ++i) multiply<N>(root_[i], columns, sum.data() + i * width, y + i * width);
}

template <unsigned N>
Eigen::MatrixXd CompressedCompliance<N>::between(std::size_t level, const std::vector<std::size_t>& nodes) const {
  return wavelet_.has_blocks() ? between<SquareMatrix<N>>(level, nodes) : between<double>(level, nodes);
}

template <unsigned N>
template <class Weight>
Eigen::MatrixXd CompressedCompliance<N>::between(std::size_t level, const std::vector<std::size_t>& nodes) const {
  constexpr std::size_t of_weight = weight_numbers<Weight>;
  const std::size_t count = rows(level), width = of_weight * nodes.size();
  std::vector<double> weights(count * width, 0.0);  // [coefficient][node]
  for (std::size_t k = 0; k < nodes.size(); ++k) {  // ones, or unit matrices
    for (std::size_t e = 0; e < of_weight; e += N + 1) weights[width * nodes[k] + of_weight * k + e] = 1;
  }
  for (std::size_t l = level; l > 0; --l) wavelet_.split_forces(l, width, weights.data());

  std::vector<FeltCoefficient<N, Weight>> felt;
  std::vector<std::size_t> place(count, count);  // in `felt`
  for (std::size_t i = 0; i < count; ++i) {
    if (!any(weights.data() + i * width, width)) continue;
    place[i] = felt.size();
    felt.emplace_back(weights.data() + i * width, nodes.size());
  }

  for (std::size_t i = 0; i < count; ++i) {
    if (place[i] == count) continue;
    const SquareMatrix<N> root = root_[i].template cast<double>();
    FeltCoefficient<N, Weight>& own = felt[place[i]];
    const SquareMatrix<N> diagonal = diagonal_[i].template cast<double>();
    own.feel(diagonal * root, own);
    for (std::size_t at = link_begin_[i]; at < link_begin_[i + 1]; ++at) {
      const auto& [other, block] = links_[at];
      if (other >= count || place[other] == count) continue;
      const SquareMatrix<N> by = block.template cast<double>();
      felt[place[other]].feel(by * root, own);
    }
  }

  RowBlocks result = RowBlocks::Zero(block_begin<N>(nodes.size()), block_begin<N>(nodes.size()));
  for (std::size_t i = 0; i < count; ++i) {
    if (place[i] != count) felt[place[i]].move(root_[i].template cast<double>(), result);
  }
  return result;
}

template <unsigned N>
std::vector<double> CompressedCompliance<N>::column(std::size_t level, std::size_t j) const {
  std::vector<double> f(block_numbers<N> * rows(level), 0.0), x(block_numbers<N> * rows(level));
  for (std::size_t c = 0; c < N; ++c) f[block_numbers<N> * j + (N + 1) * c] = 1;
  apply(level, N, f.data(), x.data());
  return x;
}

template class CompressedCompliance<1>;
template class CompressedCompliance<3>;

}  // namespace greenloop::offline
