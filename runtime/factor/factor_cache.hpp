#pragma once

#include <cstdint>

#include "runtime/factor/factor.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop {

/// Factors by set of columns; the least recently used one makes room (James & Pai 2003, section 3.2).
class FactorCache {
 public:
  /// Room for `factors` sets of `columns` each, with N rows a column, out of `arena`; null arrays while it counts.
  template <unsigned N>
  void carve(Arena& arena, std::uint32_t factors, std::uint32_t columns, bool keeps_capacitance = false) noexcept;

  /// Floats from column to column of a factor's matrix.
  [[nodiscard]] std::uint32_t stride() const noexcept { return stride_; }

  [[nodiscard]] std::uint32_t size() const noexcept { return factors_; }
  [[nodiscard]] Factor& operator[](std::uint32_t i) const noexcept { return factor_[i]; }

  /// Work units of find.
  static constexpr std::uint64_t find_work(const Prices& prices, std::uint64_t factors, std::uint64_t columns) {
    return priced(factors, prices.cached_factor) + priced(columns, prices.cached_column);
  }

  /// The factors of `set`, or null. Does not count as a use.
  [[nodiscard]] Factor* find(ColumnSet set) const noexcept;

  /// An empty place for the factors of `set`: the least recently used. It is found only after `keep`.
  [[nodiscard]] Factor& make_room(ColumnSet set) noexcept;

  /// Marks a factor as the most recently used.
  void use(Factor& factor) noexcept { factor.used = ++uses_; }

  /// Marks the factors of `set`, for which room was made last, as complete and the most recently used.
  void keep(Factor& factor, ColumnSet set) noexcept;

 private:
  Factor* factor_ = nullptr;
  std::uint32_t factors_ = 0;
  std::uint32_t stride_ = 0;
  std::uint64_t uses_ = 0;
  std::uint64_t room_key_ = 0;  ///< of the set that room was made for
};

}  // namespace greenloop
