#include "offline/compress/wavelet/equilibrated_prediction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/compress/wavelet/square_matrix.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Rows = std::vector<std::uint32_t>;

constexpr std::size_t most_terms = 6;
constexpr std::size_t candidates_per_term = 3;
constexpr double drift_variance = 1e4;      // over the nodes' own
constexpr std::size_t stream_columns = 64;  // read at a time

// what predictions reproduce but for the drift's finite variance, by columns: a constant, or the rigid motions
template <unsigned N>
using Drift = Eigen::Matrix<double, N, N == 1 ? 1 : 6>;

template <unsigned N>
Drift<N> drift_at(const Eigen::Vector3d& arm);

template <>
Drift<1> drift_at<1>(const Eigen::Vector3d&) {
  return Drift<1>::Ones();
}

template <>
Drift<3> drift_at<3>(const Eigen::Vector3d& arm) {
  Drift<3> motions;
  motions.leftCols<3>().setIdentity();
  motions.rightCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return motions;
}

// the domain nodes, by row
struct Domain {
  Domain(const SemiRegularMesh& mesh, const SurfaceWavelet& on) : wavelet(on) {
    for (const std::size_t node : on.nodes()) position.push_back(mesh.positions[node]);
  }
  // of each node of a level
  [[nodiscard]] std::size_t terms(std::size_t level) const { return std::min(most_terms, wavelet.row_end(level - 1)); }

  const SurfaceWavelet& wavelet;
  std::vector<Eigen::Vector3d> position;
};

// the rows before `end` that are nearest to a point, nearest first
Rows nearest_rows(const Domain& domain, const Eigen::Vector3d& point, std::size_t end, std::size_t count) {
  std::vector<std::pair<double, std::uint32_t>> rows;
  rows.reserve(end);
  for (std::size_t row = 0; row < end; ++row) {
    rows.emplace_back((domain.position[row] - point).squaredNorm(), static_cast<std::uint32_t>(row));
  }
  const auto last = rows.begin() + static_cast<std::ptrdiff_t>(std::min(count, end));
  std::partial_sort(rows.begin(), last, rows.end());
  Rows nearest;
  std::transform(rows.begin(), last, std::back_inserter(nearest), [](const auto& row) { return row.second; });
  return nearest;
}

// An odd node, those that may predict it, and the compliance of both per force on the latter; the node comes last.
template <unsigned N>
class Neighbourhood {
 public:
  Neighbourhood(const Domain& domain, std::size_t node, std::size_t coarser_end, std::size_t candidates)
      : node_(static_cast<std::uint32_t>(node)),
        candidates_(nearest_rows(domain, domain.position[node], coarser_end, candidates)),
        compliance_(block_begin<N>(candidates_.size() + 1), block_begin<N>(candidates_.size())) {}

  [[nodiscard]] const Rows& candidates() const { return candidates_; }

  // column: exact displacements per force on candidate k
  void add(const Eigen::Ref<const MatrixXd>& column, std::size_t k) {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      compliance_.block<N, N>(block_begin<N>(i), block_begin<N>(k)) =
          column.template middleRows<N>(block_begin<N>(candidates_[i]));
    }
    compliance_.block<N, N>(block_begin<N>(candidates_.size()), block_begin<N>(k)) =
        column.template middleRows<N>(block_begin<N>(node_));
  }

  // with the drift about the node
  [[nodiscard]] MatrixXd covariance(const Domain& domain) const {
    const std::size_t count = candidates_.size();
    MatrixXd drift(block_begin<N>(count + 1), Drift<N>::ColsAtCompileTime);
    double distance = 0, size = 0;
    for (const std::uint32_t row : candidates_)
      distance += (domain.position[row] - domain.position[node_]).squaredNorm();
    const double scale = distance > 0 ? std::sqrt(static_cast<double>(count) / distance) : 0;
    for (std::size_t i = 0; i <= count; ++i) {
      const std::uint32_t row = i < count ? candidates_[i] : node_;
      const Eigen::Vector3d arm = scale * (domain.position[row] - domain.position[node_]);
      drift.middleRows<N>(block_begin<N>(i)) = drift_at<N>(arm);
      if (i == count) continue;
      size += compliance_.block<N, N>(block_begin<N>(i), block_begin<N>(i)).trace() / static_cast<double>(N * count);
    }
    return compliance_ + drift_variance * size * drift * drift.topRows(block_begin<N>(count)).transpose();
  }

 private:
  std::uint32_t node_;
  Rows candidates_;
  MatrixXd compliance_;
};

// Candidates, one after the other those that explain most of what the ones before leave of the last node.
template <unsigned N>
std::vector<std::size_t> most_telling(MatrixXd left, std::size_t count) {
  const auto candidates = static_cast<std::size_t>(left.cols()) / N;
  std::vector<std::size_t> chosen;
  std::vector<bool> taken(candidates, false);
  while (chosen.size() < count) {
    std::size_t best = candidates;
    double most = -1;
    SquareMatrix<N> best_inverse = SquareMatrix<N>::Zero();
    for (std::size_t k = 0; k < candidates; ++k) {
      if (taken[k]) continue;
      const Index at = block_begin<N>(k);
      const SquareMatrix<N> own = left.block<N, N>(at, at), node = left.block<N, N>(left.cols(), at);
      const SquareMatrix<N> inverse = own.ldlt().solve(SquareMatrix<N>::Identity());
      const double explained = (node * inverse * node.transpose()).trace();
      if (best < candidates && !(explained > most)) continue;
      best = k;
      most = explained;
      best_inverse = inverse;
    }
    chosen.push_back(best);
    taken[best] = true;
    const Index at = block_begin<N>(best);
    const MatrixXd column = left.middleCols<N>(at) * best_inverse, row = left.middleRows<N>(at);
    left -= column * row;
  }
  return chosen;
}

struct Weights {
  Rows row;
  std::vector<std::int16_t> weight;  // N N per row, by columns
};

// false: beyond what 16 bits hold
template <unsigned N>
bool append_rounded(const SquareMatrix<N>& weight, std::vector<std::int16_t>& rounded) {
  constexpr Index n = N;
  for (Index e = 0; e < n * n; ++e) {
    const double value = std::round(weight(e % n, e / n) / double{layout::prediction_unit});
    if (!(std::abs(value) <= std::numeric_limits<std::int16_t>::max())) return false;
    rounded.push_back(static_cast<std::int16_t>(value));
  }
  return true;
}

// half of each parent in the domain; the other terms weigh nothing, and reach no node more
template <unsigned N>
Weights midpoint(const SurfaceWavelet::Odd& odd, std::size_t terms) {
  Weights weights;
  for (const std::uint32_t parent : odd.parent) {
    if (parent == SurfaceWavelet::no_row || weights.row.size() == terms) continue;
    weights.row.push_back(parent);
    append_rounded<N>(0.5 * SquareMatrix<N>::Identity(), weights.weight);
  }
  weights.row.resize(terms, weights.row.empty() ? 0 : weights.row.front());
  weights.weight.resize(block_numbers<N> * terms, 0);
  return weights;
}

template <unsigned N>
Weights solve(const Neighbourhood<N>& near, const Domain& domain, const SurfaceWavelet::Odd& odd, std::size_t terms) {
  const MatrixXd covariance = near.covariance(domain);
  const auto chosen = most_telling<N>(covariance, terms);
  MatrixXd among(block_begin<N>(terms), block_begin<N>(terms)), node(N, block_begin<N>(terms));
  for (std::size_t i = 0; i < terms; ++i) {
    const Index at = block_begin<N>(chosen[i]);
    node.middleCols<N>(block_begin<N>(i)) = covariance.block<N, N>(covariance.cols(), at);
    for (std::size_t k = 0; k < terms; ++k) {
      among.block<N, N>(block_begin<N>(k), block_begin<N>(i)) = covariance.block<N, N>(block_begin<N>(chosen[k]), at);
    }
  }
  const MatrixXd solved = among.ldlt().solve(node.transpose()).transpose();
  Weights weights;
  for (std::size_t i = 0; i < terms; ++i) {
    weights.row.push_back(near.candidates()[chosen[i]]);
    if (!append_rounded<N>(solved.middleCols<N>(block_begin<N>(i)), weights.weight)) return midpoint<N>(odd, terms);
  }
  return weights;
}

template <unsigned N>
std::vector<Neighbourhood<N>> neighbourhoods(const Domain& domain) {
  std::vector<Neighbourhood<N>> all;
  for (std::size_t level = 1; level <= domain.wavelet.finest(); ++level) {
    for (const auto& odd : domain.wavelet.odds(level)) {
      all.emplace_back(domain, odd.row, domain.wavelet.row_end(level - 1), candidates_per_term * domain.terms(level));
    }
  }
  return all;
}

template <unsigned N>
void gather_compliances(const ExactColumns& columns, std::size_t rows, std::size_t coarser,
                        std::vector<Neighbourhood<N>>& all) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> uses(coarser);  // of each column: of whom, which one
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = 0; k < all[i].candidates().size(); ++k) uses[all[i].candidates()[k]].emplace_back(i, k);
  }
  for (std::size_t first = 0; first < coarser; first += stream_columns) {
    const std::size_t count = std::min(stream_columns, coarser - first);
    const MatrixXd block = columns(first, count);
    if (block.rows() != block_begin<N>(rows) || !block.allFinite()) {
      throw std::invalid_argument("predictions: exact columns " + std::to_string(first) + " to " +
                                  std::to_string(first + count - 1) + " are not " + std::to_string(N * rows) +
                                  " finite numbers each");
    }
    for (std::size_t j = 0; j < count; ++j) {
      for (const auto& [i, k] : uses[first + j]) all[i].add(block.middleCols<N>(block_begin<N>(j)), k);
    }
  }
}

}  // namespace

template <unsigned N>
std::vector<PredictionsData> equilibrated_predictions(const SemiRegularMesh& mesh, const SurfaceWavelet& linear,
                                                      const ExactColumns& columns) {
  const std::size_t finest = linear.finest();
  std::vector<PredictionsData> predictions(finest + 1);
  if (finest == 0) return predictions;
  const Domain domain(mesh, linear);
  auto all = neighbourhoods<N>(domain);
  gather_compliances<N>(columns, linear.rows(), linear.row_end(finest - 1), all);
  auto near = all.begin();
  for (std::size_t level = 1; level <= finest; ++level) {
    PredictionsData& of_level = predictions[level];
    of_level.terms = static_cast<std::uint32_t>(domain.terms(level));
    for (const auto& odd : linear.odds(level)) {
      const Weights weights = solve<N>(*near++, domain, odd, of_level.terms);
      of_level.index.insert(of_level.index.end(), weights.row.begin(), weights.row.end());
      of_level.weight.insert(of_level.weight.end(), weights.weight.begin(), weights.weight.end());
    }
  }
  return predictions;
}

template <unsigned N>
SurfaceWavelet make_wavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                            const std::vector<double>& area, layout::Wavelet kind, const ExactColumns& columns) {
  if (kind != layout::Wavelet::equilibrated) return {mesh, flags, area, kind};
  const SurfaceWavelet linear(mesh, flags, area, layout::Wavelet::linear);
  return {mesh, flags, area, equilibrated_predictions<N>(mesh, linear, columns), N};
}

template std::vector<PredictionsData> equilibrated_predictions<1>(const SemiRegularMesh&, const SurfaceWavelet&,
                                                                  const ExactColumns&);
template std::vector<PredictionsData> equilibrated_predictions<3>(const SemiRegularMesh&, const SurfaceWavelet&,
                                                                  const ExactColumns&);

template SurfaceWavelet make_wavelet<1>(const SemiRegularMesh&, const std::vector<std::uint32_t>&,
                                        const std::vector<double>&, layout::Wavelet, const ExactColumns&);
template SurfaceWavelet make_wavelet<3>(const SemiRegularMesh&, const std::vector<std::uint32_t>&,
                                        const std::vector<double>&, layout::Wavelet, const ExactColumns&);

}  // namespace greenloop::offline
