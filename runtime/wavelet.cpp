#include "runtime/wavelet.hpp"

#include <cstddef>

namespace greenloop {
namespace {

Float4& at_offset(Float4* x, std::uint32_t byte_offset) {
  return *reinterpret_cast<Float4*>(reinterpret_cast<std::byte*>(x) + byte_offset);
}

void undo_lifting(const OddNeighbours* begin, const OddNeighbours* end, Float4* x) {
  for (const OddNeighbours* at = begin; at != end; ++at) {
    Float4 value = x[at->even];
    for (std::uint32_t k = 0; k < OddNeighbours::most; ++k) {
      value -= splat(at->lift[k]) * at_offset(x, at->byte_offset[k]);
    }
    x[at->even] = value;
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

// calls visit(odd node, parent, lift) for each domain parent of each domain node of M(level), in file order
template <class Visit>
void visit_pairs(const ModelView& view, std::uint32_t level, Visit visit) {
  const LevelView& at = view.level[level];
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    for (std::uint32_t side = 0; side < 2; ++side) {
      if (in_domain(view, at.refinement[i].parent[side])) {
        visit(at.node_begin + i, at.refinement[i].parent[side], at.refinement[i].lift[side]);
      }
    }
  }
}

std::uint32_t records_for(std::uint32_t neighbours) {
  return (neighbours + OddNeighbours::most - 1) / OddNeighbours::most;
}

}  // namespace

LiftingCounts count_lifting(const ModelView& view, std::uint32_t level) noexcept {
  constexpr std::uint32_t at_once = 1024;
  LiftingCounts counts;
  for (std::uint32_t first = 0; first < view.level[level].node_begin; first += at_once) {
    std::uint32_t neighbours[at_once] = {};
    visit_pairs(view, level, [&](std::uint32_t, std::uint32_t parent, float) {
      if (parent - first < at_once) {
        ++neighbours[parent - first];
      }
    });
    for (const std::uint32_t count : neighbours) {
      counts.records += records_for(count);
      counts.most_neighbours = count > counts.most_neighbours ? count : counts.most_neighbours;
    }
  }
  return counts;
}

void list_odd_neighbours(const ModelView& view, std::uint32_t level, std::uint32_t* begin,
                         OddNeighbours* neighbours) noexcept {
  const std::uint32_t even_count = domain_up_to(view, level - 1);
  for (std::uint32_t e = 0; e <= even_count; ++e) {
    begin[e] = 0;
  }
  visit_pairs(view, level, [&](std::uint32_t, std::uint32_t parent, float) { ++begin[domain_place(view, parent)]; });
  std::uint32_t records = 0;
  for (std::uint32_t e = 0; e < even_count; ++e) {
    const std::uint32_t here = records_for(begin[e]);
    begin[e] = records;
    records += here;
  }
  begin[even_count] = records;
  for (std::uint32_t k = 0; k < records; ++k) {
    neighbours[k] = {};
  }
  visit_pairs(view, level, [&](std::uint32_t odd, std::uint32_t parent, float lift) {
    OddNeighbours* record = neighbours + begin[domain_place(view, parent)];
    while (record->count == OddNeighbours::most) {
      ++record;
    }
    record->even = parent;
    record->byte_offset[record->count] = odd * static_cast<std::uint32_t>(sizeof(Float4));
    record->lift[record->count++] = lift;
  });
}

void inverse_transform(const ModelView& view, const Lifting& lifting, std::uint32_t field_level, Float4* x) noexcept {
  for (std::uint32_t level = 1; level < view.levels; ++level) {
    if (level <= field_level) {
      const OddNeighbours* neighbours = lifting.neighbours[level];
      undo_lifting(neighbours, neighbours + lifting.begin[level][domain_up_to(view, level - 1)], x);
    }
    predict(view.level[level], x);
  }
}

}  // namespace greenloop
