#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace greenloop::offline {

/// The points, by their columns and rising, that stand for all: of each of at most `count` clusters (k-means, begun as
/// by Arthur & Vassilvitskii 2007) the one nearest to its mean (James & Fatahalian 2003, section 4.3). points:
/// [coordinates][points]; the same points give the same. Work: 30 times points * count * coordinates.
[[nodiscard]] std::vector<Eigen::Index> representatives(const Eigen::MatrixXd& points, Eigen::Index count,
                                                        std::uint64_t seed);

}  // namespace greenloop::offline
