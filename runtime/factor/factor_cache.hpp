#pragma once

#include <cstdint>

#include "runtime/algebra/float4.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// The factors of one capacitance matrix and the contact set they belong to.
struct Factor {
  std::uint64_t key = 0;   ///< of the columns; 0: empty
  std::uint64_t used = 0;  ///< when it was last used
  std::uint32_t columns = 0;
  std::uint32_t changes = 0;          ///< nodes that came and went since it was made afresh
  std::uint32_t* column = nullptr;    ///< [columns] increasing
  std::uint32_t* node = nullptr;      ///< [columns] the same in the order of the matrix
  std::uint32_t* position = nullptr;  ///< [columns] of each column in the matrix
  Float4* matrix = nullptr;           ///< see cholesky_factor

  /// Arrays out of `arena` for sets of so many columns; null while it counts.
  void carve(Arena& arena, std::uint32_t columns_of_a_set) noexcept;
};

/// Factors by contact set; the least recently used one makes room (James & Pai 2003, section 3.2).
class FactorCache {
 public:
  /// Room for `factors` sets of `columns` each, out of `arena`; null arrays while it counts.
  void carve(Arena& arena, std::uint32_t factors, std::uint32_t columns) noexcept;

  /// Floats from column to column of a factor's matrix.
  [[nodiscard]] std::uint32_t stride() const noexcept { return stride_; }

  [[nodiscard]] std::uint32_t size() const noexcept { return factors_; }
  [[nodiscard]] Factor& operator[](std::uint32_t i) const noexcept { return factor_[i]; }

  /// Work units of find.
  static constexpr std::uint64_t find_work(std::uint64_t factors, std::uint64_t columns) {
    return factors + 2 * columns;
  }

  /// The factors of `set`, or null. Does not count as a use.
  [[nodiscard]] Factor* find(const ContactSet& set) const noexcept;

  /// An empty place for the factors of `set`: the least recently used. It is found only after `keep`.
  [[nodiscard]] Factor& make_room(const ContactSet& set) noexcept;

  /// Marks a factor as the most recently used.
  void use(Factor& factor) noexcept { factor.used = ++uses_; }

  /// Marks the factors of `set` as complete and the most recently used.
  void keep(Factor& factor, const ContactSet& set) noexcept;

 private:
  Factor* factor_ = nullptr;
  std::uint32_t factors_ = 0;
  std::uint32_t stride_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace greenloop
