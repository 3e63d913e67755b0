#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/algebra/float4.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop {

/// The factors of one capacitance matrix, of N rows and columns for each of a set of columns, and that set.
struct Factor {
  std::uint64_t key = 0;   ///< of the columns; 0: empty
  std::uint64_t used = 0;  ///< when it was last used
  std::uint32_t columns = 0;
  std::uint32_t changes = 0;          ///< nodes that came and went since it was made afresh
  std::uint32_t* column = nullptr;    ///< [columns] increasing
  std::uint32_t* node = nullptr;      ///< [columns] the same in the order of the matrix
  std::uint32_t* position = nullptr;  ///< [columns] of each column in the matrix
  Float4* matrix = nullptr;           ///< see cholesky_factor
  float* capacitance = nullptr;       ///< what was factored, laid out alike; null unless it is kept

  /// Arrays out of `arena` for sets of so many columns; null while it counts.
  template <unsigned N>
  void carve(Arena& arena, std::uint32_t columns_of_a_set, bool keeps_capacitance) noexcept;
};

/// Keeps what `matrix` holds before it is factored. For the loop; work: half the square of its order.
template <unsigned N>
void keep_capacitance(std::uint32_t columns, std::uint32_t stride, Factor& factor) noexcept;

/// The block of a kept capacitance between two columns, by their places in the set: entry (r, c) at N c + r of
/// `block`, [N * N]. For the loop; constant work.
template <unsigned N>
inline void kept_block(const Factor& factor, std::uint32_t stride, std::uint32_t row, std::uint32_t column,
                       float* block) noexcept {
  const std::size_t i = std::size_t{N} * factor.position[row];
  const std::size_t j = std::size_t{N} * factor.position[column];
  for (std::size_t c = 0; c < N; ++c) {
    for (std::size_t r = 0; r < N; ++r) {
      const std::size_t a = i + r, b = j + c;
      block[N * c + r] = factor.capacitance[a > b ? b * stride + a : a * stride + b];
    }
  }
}

/// Copies what a factor holds into another with room for it. For the loop; work: half the square of its order,
/// twice that where the capacitance is kept.
template <unsigned N>
void copy_factor(const Factor& from, std::uint32_t stride, Factor& to) noexcept;

/// Takes a node out of a factor by rank-one updates. border: [N * stride / 4] scratch. For the loop; work:
/// cholesky_remove_work, a unit a column, and half the square of its order where the capacitance is kept.
template <unsigned N>
std::uint32_t remove_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept;

/// Borders a factor by a node. border: its rows of the capacitance matrix of the factor's nodes and itself, up to the
/// diagonal. False if it is not positive definite; then it is spoilt. For the loop; work: cholesky_append_work, and N N
/// a column where the capacitance is kept.
template <unsigned N>
[[nodiscard]] bool append_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept;

/// Lists where the set's columns stand in its factor. index_of_place: [domain], layout::none before and after. For the
/// loop; work: two units a column.
void list_positions(ColumnSet set, std::uint32_t* index_of_place, Factor& factor) noexcept;

}  // namespace greenloop
