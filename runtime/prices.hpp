#pragma once

#include <cstdint>

#include "runtime/price_list.h"

namespace greenloop {

/// Rounded to the nearest.
constexpr std::uint32_t in_256ths(double units) { return (static_cast<std::uint32_t>(512 * units) + 1) / 2; }

/// What pieces of a step cost, in 256ths of a work unit each: see runtime/price_list.h. By default a unit is about an
/// instruction of an x86-64 processor, on every target, so that the same limits and budgets give the same bits.
struct Prices {
#define GREENLOOP_ROW(name, x86_64, cortex_m7, what) std::uint32_t name = in_256ths(x86_64);
  GREENLOOP_PRICES(GREENLOOP_ROW)
#undef GREENLOOP_ROW
};

/// A unit is about an instruction of a Cortex-M7.
constexpr Prices cortex_m7_prices() {
#define GREENLOOP_ROW(name, x86_64, cortex_m7, what) in_256ths(cortex_m7),
  return {GREENLOOP_PRICES(GREENLOOP_ROW)};
#undef GREENLOOP_ROW
}

/// Work units of so many at a price. No overflow below 2^56 units.
constexpr std::uint64_t priced(std::uint64_t count, std::uint32_t price) { return count * price >> 8; }

}  // namespace greenloop
