#include "offline/compress/wavelet/conditional_compliance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace greenloop::offline {
namespace {

constexpr std::size_t most_neighbours = 64;

// All couplings, scaled by the roots of the diagonal blocks.
template <unsigned N>
class ScaledCouplings {
 public:
  ScaledCouplings(const std::vector<SquareMatrix<N>>& diagonal, const std::vector<CouplingCandidates<N>>& levels) {
    for (std::size_t i = 0; i < diagonal.size(); ++i) scales_.emplace_back(diagonal[i], diagonal[i], i);
    for (const auto& level : levels) {
      for (std::size_t j = 0; j + 1 < level.begin.size(); ++j) columns_.push_back({&level, j});
    }
  }

  [[nodiscard]] std::size_t size() const { return scales_.size(); }
  [[nodiscard]] const SquareMatrix<N>& root(std::size_t i) const { return scales_[i].root(); }

  /// Zero where there is none.
  [[nodiscard]] SquareMatrix<N> block(std::size_t i, std::size_t j) const {
    if (i > j) return block(j, i).transpose();
    const auto [level, column] = columns_[j];
    const auto rows = level->row.begin();
    const auto begin = rows + static_cast<std::ptrdiff_t>(level->begin[column]);
    const auto end = rows + static_cast<std::ptrdiff_t>(level->begin[column + 1]);
    const auto it = std::lower_bound(begin, end, i);
    if (it == end || *it != i) return SquareMatrix<N>::Zero();
    return scaled(i, j, static_cast<std::size_t>(it - rows));
  }

  /// [coefficient] those it is coupled to, the strongest first.
  [[nodiscard]] std::vector<std::vector<std::size_t>> strongest() const {
    std::vector<std::vector<std::pair<float, std::uint32_t>>> neighbours(size());  // minus the norm first
    for (std::size_t j = 0; j < size(); ++j) {
      const auto [level, column] = columns_[j];
      for (std::size_t b = level->begin[column]; b < level->begin[column + 1]; ++b) {
        const std::uint32_t i = level->row[b];
        const auto norm = static_cast<float>(scaled(i, j, b).norm());
        neighbours[j].emplace_back(-norm, i);
        neighbours[i].emplace_back(-norm, static_cast<std::uint32_t>(j));
      }
    }
    std::vector<std::vector<std::size_t>> result(size());
    for (std::size_t i = 0; i < size(); ++i) {
      auto& list = neighbours[i];
      const auto end = list.begin() + static_cast<std::ptrdiff_t>(std::min(most_neighbours, list.size()));
      std::partial_sort(list.begin(), end, list.end());
      std::transform(list.begin(), end, std::back_inserter(result[i]), [](const auto& entry) { return entry.second; });
      list = {};
    }
    return result;
  }

 private:
  struct Column {
    const CouplingCandidates<N>* level;
    std::size_t column;
  };

  [[nodiscard]] SquareMatrix<N> scaled(std::size_t i, std::size_t j, std::size_t b) const {
    return scales_[i].inverse() *
           Eigen::Map<const SquareMatrixF<N>>(columns_[j].level->value.data() + block_numbers<N> * b)
               .template cast<double>() *
           scales_[j].inverse();
  }

  std::vector<CoefficientScale<N>> scales_;
  std::vector<Column> columns_;
};

// scaled; fewer neighbours where what the candidates leave out makes their matrix indefinite
template <unsigned N>
SquareMatrix<N> conditional(const ScaledCouplings<N>& couplings, std::size_t own,
                            const std::vector<std::size_t>& neighbours) {
  constexpr Eigen::Index n = N;
  for (std::size_t count = neighbours.size(); count > 0; count /= 2) {
    std::vector<std::size_t> members = {own};
    members.insert(members.end(), neighbours.begin(), neighbours.begin() + static_cast<std::ptrdiff_t>(count));
    const auto size = static_cast<Eigen::Index>(members.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n * size, n * size);
    for (Eigen::Index a = 0; a < size; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        const SquareMatrix<N> block =
            couplings.block(members[static_cast<std::size_t>(a)], members[static_cast<std::size_t>(b)]);
        matrix.template block<N, N>(n * a, n * b) = block;
        matrix.template block<N, N>(n * b, n * a) = block.transpose();
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) continue;
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n * size, n));
    return inverse.template topRows<N>().inverse();
  }
  return SquareMatrix<N>::Identity();
}

}  // namespace

template <unsigned N>
std::vector<SquareMatrix<N>> conditional_compliance(const std::vector<SquareMatrix<N>>& diagonal,
                                                    const std::vector<CouplingCandidates<N>>& couplings) {
  const ScaledCouplings<N> scaled(diagonal, couplings);
  const auto neighbours = scaled.strongest();
  std::vector<SquareMatrix<N>> result;
  result.reserve(scaled.size());
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    const SquareMatrix<N> block = conditional<N>(scaled, i, neighbours[i]);
    result.push_back(scaled.root(i) * (0.5 * (block + block.transpose())) * scaled.root(i));
  }
  return result;
}

template std::vector<SquareMatrix<1>> conditional_compliance<1>(const std::vector<SquareMatrix<1>>&,
                                                                const std::vector<CouplingCandidates<1>>&);
template std::vector<SquareMatrix<3>> conditional_compliance<3>(const std::vector<SquareMatrix<3>>&,
                                                                const std::vector<CouplingCandidates<3>>&);

}  // namespace greenloop::offline
