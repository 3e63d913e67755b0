#pragma once

#include "formats/store/green_store.hpp"

namespace greenloop::offline {

/// The largest ||U_ij - U_ji^T||_F / sqrt(||U_ii||_F ||U_jj||_F) over the nodes that are both row and column; all
/// columns must be done. Reads the store twice in tiles.
[[nodiscard]] double largest_asymmetry(const GreenStore& store);

/// What round-off leaves of it at most.
inline constexpr double most_asymmetry = 1e-8;

/// Reads every column that is done. Throws std::runtime_error, naming the file, if one cannot be read, or if all are
/// done and more asymmetric than that.
void require_sound(const GreenStore& store);

}  // namespace greenloop::offline
