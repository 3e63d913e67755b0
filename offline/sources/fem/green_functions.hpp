#pragma once

#include <cstdint>

#include "formats/store/green_store.hpp"
#include "offline/sources/fill_store.hpp"

namespace greenloop::offline {

struct SolveReport {
  int columns_solved = 0;           ///< in this run; each is three right-hand sides
  std::int64_t unknowns = 0;        ///< degrees of freedom of the volume
  std::int64_t factor_entries = 0;  ///< numbers in the Cholesky factor; 0 when nothing was missing
  double factor_seconds = 0.0;      ///< wall time of assembly and factorisation
  double solve_seconds = 0.0;       ///< wall time of the right-hand sides, writing included
  double largest_asymmetry = 0.0;   ///< see reciprocity.hpp
};

/// Throws std::runtime_error unless the contents have tetrahedra that cannot move rigidly and carry every column.
void require_solvable(const GreenStoreContents& contents);

/// Solves every column the store lacks, U = B K^-1 B^T (theory.md, section 1, in force form), from the volume, the
/// material, the interpolation and the fixed vertices in the store, and writes them block by block, so that a killed
/// run is resumed by opening the store and calling this again: the columns' bits do not depend on where it was
/// interrupted.
/// Work: one sparse factorisation, then 4 factor_entries per right-hand side. Memory: the factor and one block.
/// Throws std::runtime_error when the body is not supported, the columns depend on each other, the result is more
/// asymmetric than 1e-8, or the store has no volume.
SolveReport solve_green_functions(GreenStore& store, const FillProgressCallback& progress = {});

/// What a uniform force of 1 N/m^3 on the whole body does, along x, y and z, from the store or, where it is not done
/// there, from a factorisation: 3R x 3, m, row 3r + i axis i at row node r. solve_green_functions solves it beside the
/// columns and writes it where the store has room for it. Throws std::runtime_error if the store has no volume.
[[nodiscard]] Eigen::MatrixXd body_force_displacement(GreenStore& store);

}  // namespace greenloop::offline
