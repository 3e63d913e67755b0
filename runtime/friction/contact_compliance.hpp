#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/algebra/block.hpp"

namespace greenloop {

/// The compliance of some points, m/N, symmetric and positive definite: block (i, j) times a force at j is what it adds
/// to the displacement of i. Of the upper triangle, i <= j, the columns of blocks stand one after the other: a point
/// more is a column more. Fourth lanes are 0.
struct ContactCompliance {
  Block<3>* block = nullptr;

  static constexpr std::size_t size(std::size_t points) { return points * (points + 1) / 2; }
  [[nodiscard]] Block<3>* column(std::size_t j) const noexcept { return block + size(j); }
  [[nodiscard]] Block<3>& at(std::size_t i, std::size_t j) const noexcept { return column(j)[i]; }
};

/// Those of at most `most` points, in turn, that have a force: of candidates most have none. Apart, even and odd ones,
/// whose sums do not wait for each other. Targets without vectors, whose prices hold for any contacts, take all points.
class PushedPoints {
 public:
  static constexpr std::uint32_t most = 256;

  /// i: larger than those before. For the loop, constant work.
  void add(std::uint32_t i, const Float4& force) noexcept;

  /// Displacement of the point of a column, which is behind them, by their forces. For the loop; linear in the points
  /// that are pushed.
  [[nodiscard]] Float4 gathered(const Block<3>* column, const Float4* force) const noexcept;

 private:
  std::uint8_t point_[2][most / 2 + 1];  ///< the one behind the last is written before it is known to be pushed
  std::uint32_t count_[2] = {};
};

/// Adds to the displacements of the `count` points before that of a column what its force moves them by. For the loop;
/// linear in them.
void scatter(const Block<3>* column, Float4 force, std::uint32_t count, Float4* displacement) noexcept;

/// displacement = compliance times force, [count] each. For the loop; each block is read once.
void multiply(const ContactCompliance& compliance, std::uint32_t count, const Float4* force,
              Float4* displacement) noexcept;

}  // namespace greenloop
