#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>

#include "runtime/prices.hpp"

namespace greenloop {

/// A price by its name.
struct PriceRow {
  const char* name;
  std::uint32_t Prices::*member;
  const char* what;  ///< it is the price of
};

#define GREENLOOP_ROW(name, price, what) PriceRow{#name, &Prices::name, what},
inline constexpr PriceRow price_rows[] = {GREENLOOP_PRICES(GREENLOOP_ROW)};
#undef GREENLOOP_ROW

inline constexpr std::size_t price_count = std::size(price_rows);

}  // namespace greenloop
