#pragma once

#include "offline/multigrid/block_matrix.hpp"

namespace greenloop::offline {

/// Displacements of a level's vertices from those of the next coarser one: a row of weights a vertex, the same for each
/// axis.
struct Prolongation {
  std::vector<std::uint32_t> start;   ///< [rows + 1]
  std::vector<std::uint32_t> parent;  ///< vertices of the coarser level
  std::vector<double> weight;
  std::uint32_t coarse = 0;  ///< vertices of the coarser level

  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(start.size() - 1); }
};

/// P^T A P (003 section 3.2.1). Work: blocks times parents, twice. Deterministic. Memory beside the result: its
/// pattern.
[[nodiscard]] BlockMatrix galerkin(const BlockMatrix& matrix, const Prolongation& prolongation);

}  // namespace greenloop::offline
