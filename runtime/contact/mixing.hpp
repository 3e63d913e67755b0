#pragma once

#include <cstdint>

#include "runtime/algebra/float4.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Anderson's mixing of a fixed-point iteration y = F(x) (Walker & Ni 2011, type II): the next x is y less what the
/// last few changes of y would have added where the same mixture of the changes of y - x comes nearest to y - x.
class Mixing {
 public:
  static constexpr std::uint32_t depth = 12;  ///< changes that are remembered

  /// Arrays out of `arena` for vectors of so many times four floats; null while it counts.
  void carve(Arena& arena, std::uint32_t length) noexcept;

  /// Forgets what was. length: at most what was carved. For the loop, constant work.
  void begin(std::uint32_t length) noexcept;

  /// x: [length] what F was applied to, becomes the next; y: [length] what it gave. For the loop; work: some
  /// 6 depth multiply-adds a float.
  void mix(const Float4* y, Float4* x) noexcept;

 private:
  void remember(const Float4* y, const Float4* x) noexcept;
  std::uint32_t least_squares(double (&weight)[depth]) noexcept;

  std::uint32_t length_ = 0;
  std::uint32_t seen_ = 0;         ///< calls of mix since begin
  Float4* change_[depth] = {};     ///< of y
  Float4* deviation_[depth] = {};  ///< change of y - x
  Float4* last_ = nullptr;         ///< y
  Float4* last_step_ = nullptr;    ///< y - x
  double product_[depth][depth] = {};
};

}  // namespace greenloop
