#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace greenloop::offline {

/// The points that rows of exact columns stand for.
struct RowSet {
  std::vector<int> surface_nodes;  ///< vertices of the surface, strictly increasing
  std::size_t interior = 0;        ///< points inside the body, in rows after those

  [[nodiscard]] std::size_t size() const { return surface_nodes.size() + interior; }
};

/// What exact Green's functions come from: what a unit load at a surface node does at every row. An implementation
/// solves for them (finite elements: fem), or has measured them; fill_store brings them into a store. Offline only, one
/// thread at a time.
class ColumnSource {
 public:
  ColumnSource() = default;
  ColumnSource(const ColumnSource&) = delete;
  ColumnSource& operator=(const ColumnSource&) = delete;
  virtual ~ColumnSource() = default;

  [[nodiscard]] virtual int components() const = 0;  ///< of what is loaded and of what answers: blocks are square
  [[nodiscard]] virtual std::string_view unit() const = 0;  ///< of the numbers: answer per load, such as "m/N"
  [[nodiscard]] virtual const RowSet& rows() const = 0;
  [[nodiscard]] virtual std::span<const int> column_nodes() const = 0;  ///< that carry loads, strictly increasing
  [[nodiscard]] virtual std::size_t columns_at_once() const = 0;        ///< worth asking for in one call

  /// Columns by number, in the order asked for. With c components, row c r + i is axis i at row r, column c k + j the
  /// unit load along axis j at column_nodes()[columns[k]]. Throws std::runtime_error if they cannot be had.
  [[nodiscard]] virtual Eigen::MatrixXd read(std::span<const int> columns) = 0;
};

}  // namespace greenloop::offline
