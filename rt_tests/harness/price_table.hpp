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

#define GREENLOOP_ROW(name, x86_64, cortex_m7, what) PriceRow{#name, &Prices::name, what},
inline constexpr PriceRow price_rows[] = {GREENLOOP_PRICES(GREENLOOP_ROW)};
#undef GREENLOOP_ROW

inline constexpr std::size_t price_count = std::size(price_rows);

/// The default prices, all so many times as high that the rounding of work does not matter: for bodies that do the same
/// and count it finely.
constexpr Prices counting_prices() {
  constexpr std::uint32_t room = 64;  // some prices are sums of products of others with small numbers
  Prices prices;
  std::uint32_t dearest = 1;
  for (const PriceRow& row : price_rows) {
    dearest = prices.*row.member > dearest ? prices.*row.member : dearest;
  }
  std::uint32_t factor = 1;
  while (dearest <= ~std::uint32_t{0} / room / (2 * factor)) {
    factor *= 2;
  }
  for (const PriceRow& row : price_rows) {
    prices.*row.member *= factor;
  }
  return prices;
}

}  // namespace greenloop
