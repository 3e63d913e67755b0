#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string_view>

namespace greenloop::offline {

/// Reads exact columns [first, first + count) of the compliance, m/N: 3 rows per domain node and 3 columns per column.
using ColumnSource = std::function<Eigen::MatrixXd(std::size_t first, std::size_t count)>;

/// Called with the fraction done and what is being done; may be empty.
using Progress = std::function<void(double fraction, std::string_view stage)>;

}  // namespace greenloop::offline
