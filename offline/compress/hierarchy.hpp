#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"
#include "formats/layout.hpp"
#include "offline/compress/column_codec.hpp"

namespace greenloop::offline {

/// One node's share in the hat function of a coarser vertex.
struct HatWeight {
  std::size_t vertex = 0;
  double weight = 0;
};

/// The hat functions of one constraint level c, refined to the finest nodes by unlifted Linear subdivision, and the
/// Green's functions they stand for: column (c, k) = sum_j w_j U_j with w_j = h_k(j) a_j over the nodes j that have an
/// exact column, normalised to a unit total force (James & Pai 2003, section 6; docs/theory.md section 4).
struct ConstraintLevel {
  std::uint32_t level = 0;
  std::vector<layout::ColumnRecord> columns;  ///< one per vertex of K(c) with an exact column, by node
  std::vector<std::vector<HatWeight>> share;  ///< [exact column] its force in `columns` (vertex = column), sums to
                                              ///< one per column over all exact columns
  /// [column] its centre, the vertices of K(c) one edge away and all their ancestors, increasing.
  std::vector<std::vector<std::size_t>> near;
  std::vector<std::uint32_t>
      representatives;  ///< [node] column that stands for it; layout::none if it has no exact one
};

/// `column_nodes`: the nodes with exact columns, increasing; `area` per node [m^2]. A node's representative is the
/// column with the largest hat at that node, or the nearest one if no hat with a column reaches it.
/// Work: linear in the nodes, plus nodes without a hat times columns. Throws std::invalid_argument if a column node is
/// out of range or not increasing.
[[nodiscard]] ConstraintLevel constraint_level(const SemiRegularMesh& mesh, const std::vector<double>& area,
                                               const std::vector<std::size_t>& column_nodes, std::uint32_t level);

/// Columns of coarser constraint levels, gathered while the exact ones stream by. Memory: 36 bytes times rows times the
/// levels' columns, in total about a third of the dense matrix in single precision.
class CoarseColumns {
 public:
  CoarseColumns(const ConstraintLevel& level, std::size_t rows);

  /// Adds the exact columns [first, first + block columns / 3).
  void add(const Eigen::MatrixXd& block, std::size_t first);

  /// Reads columns back; valid while this object lives.
  [[nodiscard]] ColumnSource source() const;

 private:
  const ConstraintLevel* level_;
  Eigen::MatrixXf columns_;
};

}  // namespace greenloop::offline
