#pragma once

#include <cstdint>

#include "runtime/price_list.h"

namespace greenloop {

/// What pieces of a step cost, in 256ths of a work unit each: see runtime/price_list.h.
struct Prices {
#define GREENLOOP_ROW(name, price, what) std::uint32_t name = (price);
  GREENLOOP_PRICES(GREENLOOP_ROW)
#undef GREENLOOP_ROW
};

/// Where nodes have one component.
constexpr Prices scalar_prices() {
  Prices prices;
  prices.slot = 8 * 256;
  prices.scaled_block = 8 * 256;
  prices.meeting = prices.meeting_by_blocks = 256;
  prices.pair_visit = 2 * 256;
  prices.pair_visit_by_blocks = 4 * 256;
  prices.panel_row = 2 * 256;
  prices.stored_entry = 256;
  prices.force_visit = 256;
  prices.force_visit_by_blocks = 2 * 256;
  prices.coefficient = 44 * 256;
  prices.summed_block = 2 * 256;
  prices.scaled_sum = 6 * 256;
  prices.detail = 3 * 256;
  prices.linear_node = 2 * 256;
  prices.butterfly_node = 8 * 256;
  prices.block_node = 2 * 256;
  prices.block_term = 256;
  return prices;
}

/// Work units of so many at a price. No overflow below 2^56 units.
constexpr std::uint64_t priced(std::uint64_t count, std::uint32_t price) { return count * price >> 8; }

}  // namespace greenloop
