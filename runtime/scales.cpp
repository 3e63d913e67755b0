#include "runtime/scales.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t size = 4;  // of a group

void scale_group(const RootGroup& root, Float4* x) {
  const Float4 low_xy = __builtin_shufflevector(x[0], x[1], 0, 4, 1, 5);
  const Float4 high_xy = __builtin_shufflevector(x[2], x[3], 0, 4, 1, 5);
  const Float4 low_z = __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7);
  const Float4 high_z = __builtin_shufflevector(x[2], x[3], 2, 6, 3, 7);
  const Float4 a = __builtin_shufflevector(low_xy, high_xy, 0, 1, 4, 5);
  const Float4 b = __builtin_shufflevector(low_xy, high_xy, 2, 3, 6, 7);
  const Float4 c = __builtin_shufflevector(low_z, high_z, 0, 1, 4, 5);

  const Float4* r = root.element;
  const Float4 to_a = (r[0] * a + r[1] * b) + r[2] * c;
  const Float4 to_b = (r[1] * a + r[3] * b) + r[4] * c;
  const Float4 to_c = (r[2] * a + r[4] * b) + r[5] * c;

  const Float4 low_ab = __builtin_shufflevector(to_a, to_b, 0, 4, 1, 5);
  const Float4 high_ab = __builtin_shufflevector(to_a, to_b, 2, 6, 3, 7);
  const Float4 low_c = __builtin_shufflevector(to_c, Float4{}, 0, 4, 1, 5);
  const Float4 high_c = __builtin_shufflevector(to_c, Float4{}, 2, 6, 3, 7);
  x[0] = __builtin_shufflevector(low_ab, low_c, 0, 1, 4, 5);
  x[1] = __builtin_shufflevector(low_ab, low_c, 2, 3, 6, 7);
  x[2] = __builtin_shufflevector(high_ab, high_c, 0, 1, 4, 5);
  x[3] = __builtin_shufflevector(high_ab, high_c, 2, 3, 6, 7);
}

void fill(const layout::Scale* scales, std::uint32_t groups, RootGroup* roots) {
  for (std::uint32_t g = 0; g < groups; ++g) {
    for (std::uint32_t k = 0; k < 6; ++k) {
      for (std::uint32_t i = 0; i < size; ++i) {
        roots[g].element[k][i] = scales[size * g + i].root[k];
      }
    }
  }
}

}  // namespace

Roots place_roots(Arena& arena, const ModelView& view) noexcept {
  Roots roots;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const std::uint32_t groups = view.level[q].counts->domain_count / size;
    auto* of_level = arena.take<RootGroup>(groups);
    if (of_level != nullptr) {
      fill(view.level[q].scales, groups, of_level);
    }
    roots.level[q] = of_level;
  }
  return roots;
}

void scale_back(const ModelView& view, const Roots& roots, std::uint32_t field_level, Float4* x) noexcept {
  for (std::uint32_t q = 0; q <= field_level; ++q) {
    const LevelView& level = view.level[q];
    Float4* of_level = x + level.node_begin;
    const std::uint32_t count = level.counts->domain_count;
    for (std::uint32_t g = 0; g < count / size; ++g) {
      scale_group(roots.level[q][g], of_level + std::size_t{size} * g);
    }
    for (std::uint32_t i = count - count % size; i < count; ++i) {
      of_level[i] = product(symmetric_block(level.scales[i].root), of_level[i]);
    }
  }
}

}  // namespace greenloop
