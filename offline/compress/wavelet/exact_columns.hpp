#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

namespace greenloop::offline {

/// Reads exact columns [first, first + count) of the compliance, m/N, between nodes of N numbers each: N rows per
/// domain node and N columns per column.
using ExactColumns = std::function<Eigen::MatrixXd(std::size_t first, std::size_t count)>;

}  // namespace greenloop::offline
