#include "runtime/wavelet.hpp"

namespace greenloop {
namespace {

void undo_lifting(const ModelView& view, const std::uint32_t* begin, const OddNeighbour* neighbour, std::uint32_t level,
                  Float4* x) {
  for (std::uint32_t q = 0; q < level; ++q) {
    Float4* even = x + view.level[q].node_begin;
    const std::uint32_t count = view.level[q].counts->domain_count;
    for (std::uint32_t i = 0; i < count; ++i) {
      Float4 value = even[i];
      for (std::uint32_t k = begin[i]; k < begin[i + 1]; ++k) {
        value -= splat(neighbour[k].lift) * x[neighbour[k].node];
      }
      even[i] = value;
    }
    begin += count;
  }
}

void predict(const LevelView& level, Float4* x) {
  Float4* odd = x + level.node_begin;
  const std::uint32_t count = level.counts->domain_count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t* parent = level.refinement[i].parent;
    odd[i] += splat(0.5F) * (x[parent[0]] + x[parent[1]]);
  }
}

}  // namespace

std::uint64_t lifting_pairs(const ModelView& view, std::uint32_t level) noexcept {
  const LevelView& at = view.level[level];
  std::uint64_t pairs = 0;
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    for (const std::uint32_t parent : at.refinement[i].parent) {
      pairs += in_domain(view, parent) ? 1 : 0;
    }
  }
  return pairs;
}

std::uint32_t most_odd_neighbours(const ModelView& view, std::uint32_t level) noexcept {
  constexpr std::uint32_t at_once = 1024;
  const LevelView& at = view.level[level];
  std::uint32_t most = 0;
  for (std::uint32_t first = 0; first < at.node_begin; first += at_once) {
    std::uint32_t neighbours[at_once] = {};
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      for (const std::uint32_t parent : at.refinement[i].parent) {
        if (parent - first < at_once && in_domain(view, parent)) {
          const std::uint32_t now = ++neighbours[parent - first];
          most = now > most ? now : most;
        }
      }
    }
  }
  return most;
}

void list_odd_neighbours(const ModelView& view, std::uint32_t level, std::uint32_t* begin,
                         OddNeighbour* neighbour) noexcept {
  const LevelView& at = view.level[level];
  const std::uint32_t even_count = domain_up_to(view, level - 1);
  for (std::uint32_t e = 0; e <= even_count; ++e) {
    begin[e] = 0;
  }
  // count, then end of each list, then fill from the back so that every list is in file order
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    for (const std::uint32_t parent : at.refinement[i].parent) {
      if (in_domain(view, parent)) {
        ++begin[domain_place(view, parent)];
      }
    }
  }
  for (std::uint32_t e = 1; e <= even_count; ++e) {
    begin[e] += begin[e - 1];
  }
  for (std::uint32_t i = at.counts->domain_count; i-- > 0;) {
    const layout::RefinementRecord& odd = at.refinement[i];
    for (std::uint32_t side = 2; side-- > 0;) {
      if (in_domain(view, odd.parent[side])) {
        neighbour[--begin[domain_place(view, odd.parent[side])]] = {at.node_begin + i, odd.lift[side]};
      }
    }
  }
}

void inverse_transform(const ModelView& view, const OddNeighbours& neighbours, std::uint32_t field_level,
                       Float4* x) noexcept {
  for (std::uint32_t level = 1; level < view.levels; ++level) {
    if (level <= field_level) {
      undo_lifting(view, neighbours.begin[level], neighbours.neighbour[level], level, x);
    }
    predict(view.level[level], x);
  }
}

}  // namespace greenloop
