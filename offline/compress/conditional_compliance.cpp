#include "offline/compress/conditional_compliance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>
#include <utility>

namespace greenloop::offline {
namespace {

constexpr std::size_t most_neighbours = 24;

struct Neighbour {
  float norm;
  std::uint32_t coefficient;
};

// [coefficient] those it is coupled to, the strongest first
std::vector<std::vector<Neighbour>> strongest(const CouplingCandidates& couplings) {
  std::vector<std::vector<Neighbour>> neighbours(couplings.begin.size() - 1);
  for (std::uint32_t j = 0; j + 1 < couplings.begin.size(); ++j) {
    for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
      neighbours[j].push_back({couplings.norm[b], couplings.row[b]});
      neighbours[couplings.row[b]].push_back({couplings.norm[b], j});
    }
  }
  for (auto& list : neighbours) {
    const auto end = list.begin() + static_cast<std::ptrdiff_t>(std::min(most_neighbours, list.size()));
    std::partial_sort(list.begin(), end, list.end(), [](const Neighbour& a, const Neighbour& b) {
      return std::pair(-a.norm, a.coefficient) < std::pair(-b.norm, b.coefficient);
    });
    list.erase(end, list.end());
  }
  return neighbours;
}

Eigen::Matrix3d coupling(const CouplingCandidates& couplings, std::uint32_t i, std::uint32_t j) {
  if (i > j) return coupling(couplings, j, i).transpose();
  const auto begin = couplings.row.begin() + static_cast<std::ptrdiff_t>(couplings.begin[j]);
  const auto end = couplings.row.begin() + static_cast<std::ptrdiff_t>(couplings.begin[j + 1]);
  const auto it = std::lower_bound(begin, end, i);
  if (it == end || *it != i) return Eigen::Matrix3d::Zero();
  return Eigen::Map<const Eigen::Matrix3f>(couplings.value.data() + 9 * (it - couplings.row.begin())).cast<double>();
}

// scaled; fewer neighbours where what the candidates leave out makes their matrix indefinite
Eigen::Matrix3d conditional(const CouplingCandidates& couplings, std::uint32_t own,
                            const std::vector<Neighbour>& neighbours) {
  for (std::size_t count = neighbours.size(); count > 0; count /= 2) {
    std::vector<std::uint32_t> members = {own};
    for (std::size_t n = 0; n < count; ++n) members.push_back(neighbours[n].coefficient);
    const auto size = static_cast<Eigen::Index>(members.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3 * size, 3 * size);
    for (Eigen::Index a = 0; a < size; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        const Eigen::Matrix3d block =
            coupling(couplings, members[static_cast<std::size_t>(a)], members[static_cast<std::size_t>(b)]);
        matrix.block<3, 3>(3 * a, 3 * b) = block;
        matrix.block<3, 3>(3 * b, 3 * a) = block.transpose();
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) continue;
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(3 * size, 3));
    return inverse.topRows<3>().inverse();
  }
  return Eigen::Matrix3d::Identity();
}

}  // namespace

std::vector<Eigen::Matrix3d> conditional_compliance(const std::vector<Eigen::Matrix3d>& diagonal,
                                                    const CouplingCandidates& couplings) {
  const auto neighbours = strongest(couplings);
  std::vector<Eigen::Matrix3d> result;
  for (std::uint32_t i = 0; i < diagonal.size(); ++i) {
    const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(diagonal[i]).operatorSqrt();
    const Eigen::Matrix3d scaled = conditional(couplings, i, neighbours[i]);
    result.push_back(root * (0.5 * (scaled + scaled.transpose())) * root);
  }
  return result;
}

std::vector<Eigen::Matrix3d> conditional_compliance(const DenseCompliance& compliance) {
  const auto rows = static_cast<Eigen::Index>(compliance.rows());
  Eigen::MatrixXd matrix(3 * rows, 3 * rows);
  for (Eigen::Index j = 0; j < rows; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      matrix.block<3, 3>(3 * i, 3 * j) = compliance.block(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) {
    throw std::invalid_argument(
        "compression: the compliance between the averages of a coarse level is not positive "
        "definite; are the exact columns those of an elastic body?");
  }
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(3 * rows, 3 * rows));
  std::vector<Eigen::Matrix3d> result;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Matrix3d block = inverse.block<3, 3>(3 * i, 3 * i);
    result.push_back((0.5 * (block + block.transpose())).inverse());
  }
  return result;
}

}  // namespace greenloop::offline
