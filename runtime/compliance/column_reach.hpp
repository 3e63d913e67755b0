#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

// What columns of the capacitance matrix reach, followed through the coarser levels without any memory but the stack:
// what bound_columns sums.

/// Bounds of the blocks that coefficients of levels 0..c have with those of each of these levels.
struct Degrees {
  static constexpr std::uint32_t entries = 2304;
  std::uint32_t levels = 0;
  std::uint32_t exact = 0;                                          ///< coefficients, the first, that are counted each
  std::uint16_t first[entries] = {};                                ///< [exact][levels]
  std::uint32_t most[layout::max_levels][layout::max_levels] = {};  ///< [level][with] of any other coefficient

  /// Adds those of a coefficient. blocks: [levels].
  void add(std::uint32_t level, std::uint32_t place, std::uint32_t* blocks) const noexcept;
};

/// Start-up; work: that of count_blocks, for every two levels.
void fill_degrees(const ModelView& view, std::uint32_t c, Degrees& degrees) noexcept;

/// Some coefficients among a few thousand, and all that come after those.
struct Places {
  static constexpr std::uint32_t most = 4096;
  std::uint64_t bits[most / 64] = {};

  void add(std::uint32_t place) noexcept {
    if (place < most) {
      bits[place / 64] |= std::uint64_t{1} << place % 64;
    }
  }
  /// Of first .. end-1.
  [[nodiscard]] std::uint64_t count(std::uint32_t first, std::uint32_t end) const noexcept {
    std::uint64_t sum = 0;
    for (std::uint32_t place = first; place < end; ++place) {
      sum += place < most ? bits[place / 64] >> place % 64 & 1 : 1;
    }
    return sum;
  }
};

/// What one column reaches, by levels.
struct Reach {
  std::uint32_t coefficients[layout::max_levels] = {};
  std::uint32_t blocks[layout::max_levels] = {};  ///< that those have with the coefficients of each level
  std::uint32_t forced[layout::max_levels] = {};  ///< odd nodes that its force is shared among
  std::uint32_t even[layout::max_levels] = {};    ///< nodes of the next coarser level that it goes on to

  [[nodiscard]] std::uint32_t all_coefficients() const noexcept {
    std::uint32_t sum = 0;
    for (const std::uint32_t of_level : coefficients) {
      sum += of_level;
    }
    return sum;
  }
};

/// Columns that are followed together.
struct ReachBatch {
  static constexpr std::uint32_t most = 4;
  std::uint32_t count = 0;
  std::uint32_t column[most] = {};
  Reach reach[most];
};

/// Fills in what the columns reach, and adds the coefficients to `reached`. bound_reach must have bounded their level.
/// With lifted wavelets whose next coarser level has more than 576 coefficients, those that are lifted are not
/// listed: as many of the largest counts stand for them, and all count as reached. Start-up; work: a unit a node of
/// each support; with lifted wavelets one for every coefficient besides.
void follow(const ModelView& view, const LiftingCounts* lifting, const Degrees& degrees, ReachBatch& batch,
            Places& reached) noexcept;

/// Whether the lifted neighbours of a level are listed.
[[nodiscard]] bool lists_neighbours(const ModelView& view, std::uint32_t level) noexcept;

}  // namespace greenloop
