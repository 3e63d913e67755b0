#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"
#include "offline/compress/hierarchy.hpp"
#include "offline/compress/level_compression.hpp"

namespace greenloop::offline {

/// Small contact patches whose exact compliance is gathered while the exact columns stream by, to measure what the
/// compressed model makes of the force that holds them.
class ContactPatches {
 public:
  /// At most 32 patches spread evenly over the columns: each the 16 nearest nodes with a column (all if there are
  /// fewer).
  ContactPatches(const SemiRegularMesh& mesh, const std::vector<std::size_t>& column_nodes,
                 const LiftedLinear& wavelet);

  /// Reads the patches' entries out of the exact columns [first, first + block columns / 3).
  void add(const Eigen::MatrixXd& block, std::size_t first);

  /// Worst relative error of the total force that holds a patch displaced as a whole along x, y or z, when its nodes
  /// are merged into their representatives at `level` (mean displacement) and solved with the compressed columns.
  /// Infinite if a compressed patch is singular.
  [[nodiscard]] double worst_force_error(const LiftedLinear& wavelet, const ConstraintLevel& level,
                                         const CompressedLevel& compressed) const;

 private:
  struct Patch {
    std::vector<std::size_t> columns;  ///< exact column numbers
    Eigen::MatrixXd compliance;        ///< 3n x 3n, m/N
  };
  std::vector<Patch> patches_;
  std::vector<std::size_t> nodes_;  ///< of each exact column
  std::vector<std::size_t> rows_;   ///< domain row of each exact column's node
};

/// Column `j` of compressed sections, reconstructed in single precision as the runtime does; (rows + 1) * 9 values.
[[nodiscard]] std::vector<float> decode_stored_column(const LiftedLinear& wavelet,
                                                      const std::vector<BlocksData>& blocks, std::size_t j);

}  // namespace greenloop::offline
