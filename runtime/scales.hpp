#pragma once

#include "formats/view.hpp"
#include "runtime/arena.hpp"
#include "runtime/float4.hpp"

namespace greenloop {

/// The symmetric roots of four coefficients next to each other: xx, xy, xz, yy, yz, zz.
struct RootGroup {
  Float4 element[6];
};

/// The roots of whole groups of four; a level's last three coefficients or fewer are in the file alone.
struct Roots {
  const RootGroup* level[layout::max_levels] = {};  ///< [q][domain nodes of M(q) / 4]
};

/// Carves the groups out of `arena` and fills them in, unless it only counts. Start-up; linear in the domain.
[[nodiscard]] Roots place_roots(Arena& arena, const ModelView& view) noexcept;

/// x = root x at the domain nodes of levels 0..field_level, by file index; fourth lanes become 0. For the loop; work: 9
/// units a node.
void scale_back(const ModelView& view, const Roots& roots, std::uint32_t field_level, Float4* x) noexcept;

}  // namespace greenloop
