#pragma once

#include <cstdint>

#include "formats/ready/base_columns.hpp"
#include "formats/view.hpp"
#include "runtime/algebra/block.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

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

/// Where they are made, or found in a file that is ready.
template <unsigned N>
class BaseColumnsMaker {
 public:
  /// Arrays out of `arena`; null while it counts. Start-up; linear in the blocks, nothing if the file is ready.
  void carve(Arena& arena, const ModelView& view) noexcept;

  /// Which there are: none if too few of their blocks exist. After carve.
  [[nodiscard]] const BaseColumns& columns() const { return made_; }

  /// Makes them. Start-up; linear in the blocks, nothing if the file is ready.
  [[nodiscard]] BaseColumns make(const ModelView& view) noexcept;

 private:
  BaseColumns made_;
  bool is_ready_ = false;
  std::byte* value_ = nullptr;
};

}  // namespace greenloop
