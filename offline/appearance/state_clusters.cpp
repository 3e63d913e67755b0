#include "offline/appearance/state_clusters.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

Index nearest_column(const MatrixXd& columns, const Eigen::VectorXd& to) {
  Index nearest = 0;
  (columns.colwise() - to).colwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

/// The first with any point, each other with one far from those before: by the squared distance.
MatrixXd first_means(const MatrixXd& points, Index count, std::mt19937_64& random) {
  MatrixXd means(points.rows(), count);
  Eigen::RowVectorXd distance = Eigen::RowVectorXd::Constant(points.cols(), std::numeric_limits<double>::infinity());
  Index chosen = static_cast<Index>(random() % static_cast<std::uint64_t>(points.cols()));
  for (Index k = 0; k < count; ++k) {
    means.col(k) = points.col(chosen);
    distance = distance.cwiseMin((points.colwise() - means.col(k)).colwise().squaredNorm());
    double left = distance.sum() * static_cast<double>(random() >> 11U) * 0x1p-53;
    for (chosen = 0; chosen + 1 < points.cols() && left >= distance[chosen]; ++chosen) left -= distance[chosen];
  }
  return means;
}

}  // namespace

std::vector<Index> representatives(const MatrixXd& points, Index count, std::uint64_t seed) {
  constexpr int most_rounds = 30;
  std::mt19937_64 random(seed);
  MatrixXd means = first_means(points, std::min(count, points.cols()), random);
  std::vector<Index> cluster(static_cast<std::size_t>(points.cols()), -1);
  for (int round = 0; round < most_rounds; ++round) {
    bool changed = false;
    MatrixXd sum = MatrixXd::Zero(means.rows(), means.cols());
    Eigen::VectorXd members = Eigen::VectorXd::Zero(means.cols());
    for (Index i = 0; i < points.cols(); ++i) {
      const Index nearest = nearest_column(means, points.col(i));
      changed |= nearest != cluster[static_cast<std::size_t>(i)];
      cluster[static_cast<std::size_t>(i)] = nearest;
      sum.col(nearest) += points.col(i);
      members[nearest] += 1;
    }
    for (Index k = 0; k < means.cols(); ++k) {
      if (members[k] > 0) means.col(k) = sum.col(k) / members[k];
    }
    if (!changed) break;
  }
  std::set<Index> chosen;
  for (Index k = 0; k < means.cols(); ++k) chosen.insert(nearest_column(points, means.col(k)));
  return {chosen.begin(), chosen.end()};
}

}  // namespace greenloop::offline
