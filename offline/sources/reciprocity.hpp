#pragma once

#include "formats/store/green_store.hpp"

namespace greenloop::offline {

/// The largest ||U_ij - U_ji^T||_F / sqrt(||U_ii||_F ||U_jj||_F) over the nodes that are both row and column; all
/// columns must be done. Reads the store twice in tiles.
[[nodiscard]] double largest_asymmetry(const GreenStore& store);

}  // namespace greenloop::offline
