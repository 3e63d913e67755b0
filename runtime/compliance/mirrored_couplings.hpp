#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

/// Where they are made, of N x N blocks, or found in a file that is ready.
template <unsigned N>
class MirroredCouplingsMaker {
 public:
  /// Arrays out of `arena`; null while it counts. base: what need not be held. Start-up; linear in the blocks.
  void carve(Arena& arena, const ModelView& view, const BaseColumns& base) noexcept;

  /// Makes them, without the blocks that move coefficients whose byte in `read` is 0. read: [domain], that of the file
  /// if it is ready. Start-up; linear in the blocks, nothing if the file is ready.
  [[nodiscard]] MirroredCouplings make(const ModelView& view, const BaseColumns& base,
                                       const std::uint8_t* read) noexcept;

 private:
  std::uint32_t* begin_[layout::layers] = {};
  void* index_[layout::layers] = {};
  std::byte* value_[layout::layers] = {};
};

/// Marks with 1 the coefficients that the displacement of a node with layout::node_read depends on, the others with 0.
/// read: [domain]; touched: clear, and so again afterwards. Start-up; linear in what such nodes reach.
void mark_read(const Refinement& refinement, Touched& touched, std::uint8_t* read) noexcept;

}  // namespace greenloop
