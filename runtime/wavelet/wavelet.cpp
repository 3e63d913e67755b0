#include "runtime/wavelet/wavelet.hpp"

#include <bit>
#include <cstddef>
#include <cstring>

#include "formats/stored_blocks.hpp"

namespace greenloop {
namespace {

template <class Vector>
Vector& at_offset(Vector* x, std::uint32_t byte_offset) {
  return *reinterpret_cast<Vector*>(reinterpret_cast<std::byte*>(x) + byte_offset);
}

template <class Vector>
void undo_lifting(const LevelView& level, const ParentOffsets* parents, const Vector* coefficients, Vector* x) {
  const ParentOffsets* of_level = parents + level.domain_begin;
  const Vector* detail = coefficients + level.domain_begin;
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    const float* lift = level.refinement[i].lift;
    at_offset(x, of_level[i].byte_offset[0]) -= scaled(lift[0], detail[i]);
    at_offset(x, of_level[i].byte_offset[1]) -= scaled(lift[1], detail[i]);
  }
}

// 0 outside the domain
template <class Vector>
void clear_fixed(const LevelView& level, Vector* x) {
  const std::uint32_t count = level.counts->domain_count;
  std::memset(x + level.node_begin + count, 0, sizeof(Vector) * (level.counts->node_count - count));
}

// moves the coefficients of level 0 to its nodes
template <class Vector>
void start(const LevelView& level, Vector* coefficients, Vector* x) {
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    x[i] = added(Vector{}, coefficients[i]);  // no zero is negative
    coefficients[i] = Vector{};
  }
  clear_fixed(level, x);
}

// halfway between the parents; the level's details, if any are given, are moved to its nodes
template <class Vector>
void predict(const LevelView& level, const ParentOffsets* parents, Vector* details, Vector* x) {
  Vector* odd = x + level.node_begin;
  const ParentOffsets* of_level = parents + level.domain_begin;
  const std::uint32_t count = level.counts->domain_count;
  const auto halfway = [&](std::uint32_t i) {
    const auto both = std::bit_cast<std::uint64_t>(of_level[i]);  // one load; their order does not matter
    return mean(at_offset(x, static_cast<std::uint32_t>(both)), at_offset(x, static_cast<std::uint32_t>(both >> 32)));
  };
  if (details == nullptr) {
    for (std::uint32_t i = 0; i < count; ++i) {
      odd[i] = halfway(i);
    }
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    odd[i] = added(halfway(i), details[i]);
    details[i] = Vector{};
  }
}

template <class Vector>
void add_stencils(const LevelView& level, Vector* x) {
  Vector* odd = x + level.node_begin;
  const std::uint32_t count = level.counts->domain_count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& [wing, outer] = level.stencils[i];
    if (wing[0] != layout::none) {
      odd[i] += scaled(layout::wing_weight, x[wing[0]] + x[wing[1]]);
      odd[i] += scaled(layout::outer_weight, (x[outer[0]] + x[outer[1]]) + (x[outer[2]] + x[outer[3]]));
    }
  }
}

// calls visit(odd node, parent, lift) for each parent that each domain node of M(level) is lifted into, in file order
template <class Visit>
void visit_pairs(const ModelView& view, std::uint32_t level, Visit visit) {
  const LevelView& at = view.level[level];
  for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
    for (std::uint32_t side = 0; side < 2; ++side) {
      if (at.refinement[i].lift[side] != 0) {
        visit(at.node_begin + i, at.refinement[i].parent[side], at.refinement[i].lift[side]);
      }
    }
  }
}

std::size_t term_count(const LevelView& level) {
  return std::size_t{level.predictions.terms} * level.counts->domain_count;
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
    record->node[record->count] = odd;
    record->lift[record->count++] = lift;
  });
}

template <unsigned N>
void PredictionOffsets<N>::carve(Arena& arena, const ModelView& view) noexcept {
  if (!prediction_of(view).blocks) {
    parents = arena.take<ParentOffsets>(view.domain_count);
    return;
  }
  std::uint64_t terms = 0;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    terms += term_count(view.level[q]);
  }
  sources = arena.take<std::uint32_t>(terms);
}

template <unsigned N>
void PredictionOffsets<N>::fill(const ModelView& view) noexcept {
  predict_blocks = fastest_predict_blocks<N>();
  constexpr std::uint32_t bytes = sizeof(Vector<N>);
  const bool blocks = prediction_of(view).blocks;
  std::uint32_t* source = sources;
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    if (blocks) {
      for (std::size_t term = 0; term < term_count(level); ++term) {
        *source++ = domain_node(view, stored_source(level.predictions, term)) * bytes;
      }
      continue;
    }
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::uint32_t side = 0; side < 2; ++side) {
        parents[level.domain_begin + i].byte_offset[side] = level.refinement[i].parent[side] * bytes;
      }
    }
  }
}

template <unsigned N>
void inverse_transform(const ModelView& view, const PredictionOffsets<N>& offsets, const FieldLevels& levels,
                       Vector<N>* coefficients, Vector<N>* x) noexcept {
  const auto wavelet = static_cast<layout::Wavelet>(view.info->wavelet);
  const bool lifted = layout::is_lifted(wavelet);
  const std::uint32_t* sources = offsets.sources;
  start(view.level[0], coefficients, x);
  for (std::uint32_t q = 1; q <= levels.nodes; ++q) {
    const LevelView& level = view.level[q];
    if (lifted && q <= levels.details) {
      undo_lifting(level, offsets.parents, coefficients, x);
    }
    Vector<N>* const details = q <= levels.details ? coefficients + level.domain_begin : nullptr;
    if (wavelet == layout::Wavelet::equilibrated) {
      offsets.predict_blocks(level, sources, details, x);
      sources += term_count(level);
    } else {
      predict(level, offsets.parents, details, x);
    }
    clear_fixed(level, x);
    if (level.stencils != nullptr) {
      add_stencils(level, x);
    }
  }
}

template struct PredictionOffsets<1>;
template struct PredictionOffsets<3>;
template void inverse_transform<1>(const ModelView&, const PredictionOffsets<1>&, const FieldLevels&, Vector<1>*,
                                   Vector<1>*) noexcept;
template void inverse_transform<3>(const ModelView&, const PredictionOffsets<3>&, const FieldLevels&, Vector<3>*,
                                   Vector<3>*) noexcept;

}  // namespace greenloop
