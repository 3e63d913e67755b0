#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// The couplings of the coefficients of level 0 with those after them, where nearly all exist, of bodies of 512
/// coefficients and more: whole columns without indices, eight coefficients side by side, so that a field sums them
/// without gathering. They hold the layers of 8 and 4 bits, as far as these have one quantum; what needs 16 bits stays
/// among the mirrored couplings.
struct BaseColumns {
  static constexpr std::uint32_t quantum_layer = 2;  ///< whose quantum they have: that of 8 bits
  static constexpr std::uint32_t width = 8;          ///< coefficients of a tile, of consecutive places

  /// Of a tile of N x N blocks, whose elements k are the 8 bytes from 8 k on.
  template <unsigned N>
  static constexpr std::size_t tile_bytes = std::size_t{N * N} * width;

  std::uint32_t columns = 0;         ///< level 0's, or none
  std::uint32_t tiles = 0;           ///< of a column
  bool holds[layout::layers] = {};   ///< its layers
  const std::byte* value = nullptr;  ///< [columns * tiles * tile_bytes<N>]

  template <unsigned N>
  [[nodiscard]] const std::byte* column(std::uint32_t c) const {
    return value + tile_bytes<N> * tiles * c;
  }
};

/// Sums of a tile's displacements: each component of its first four coefficients and of the others.
template <unsigned N>
struct TileSums {
  Float4 of[N][2];
};

/// Work units of a tile in a sum, whose values are side by side.
template <unsigned N>
inline constexpr std::uint64_t tile_work = BaseColumns::tile_bytes<N> / 2;

/// sums += tiles * force, for `count` of each. force: times the layers' quantum; its fourth lane is not looked at. All
/// of these give the same bits. For the loop; work: tile_work units per tile.
template <unsigned N>
using AddTiles = void (*)(const std::byte* tiles, std::uint32_t count, Vector<N> force, TileSums<N>* sums) noexcept;

/// On every processor.
template <unsigned N>
void add_tiles(const std::byte* tiles, std::uint32_t count, Vector<N> force, TileSums<N>* sums) noexcept;

/// The fastest on this processor. Start-up.
template <unsigned N>
[[nodiscard]] AddTiles<N> fastest_add_tiles() noexcept;
template <>
[[nodiscard]] AddTiles<1> fastest_add_tiles<1>() noexcept;
template <>
[[nodiscard]] AddTiles<3> fastest_add_tiles<3>() noexcept;

/// Tiles that hold the first `coefficients`.
constexpr std::uint32_t tiles_of(std::uint32_t coefficients) {
  return (coefficients + BaseColumns::width - 1) / BaseColumns::width;
}

/// Where they are made.
template <unsigned N>
class BaseColumnsMaker {
 public:
  /// Arrays out of `arena`; null while it counts. Start-up; linear in the blocks.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Which there are: none if too few of their blocks exist. After carve.
  [[nodiscard]] const BaseColumns& columns() const { return made_; }

  /// Makes them. Start-up; linear in the blocks.
  [[nodiscard]] BaseColumns make(const ModelView& view) noexcept;

 private:
  BaseColumns made_;
  std::byte* value_ = nullptr;
};

}  // namespace greenloop
