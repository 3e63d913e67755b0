#include "runtime/field_couplings.hpp"

#include <cstddef>
#include <cstring>

#include "runtime/couplings.hpp"
#include "runtime/domain.hpp"

namespace greenloop {
namespace {

static_assert(layout::field_layers == 3 && layout::layer[0].value_bits == 16 && layout::layer[1].value_bits == 8 &&
              layout::layer[2].value_bits == 4);

// calls visit(row, column, section, position) for every block of a layer, by columns
template <class Visit>
void visit_layer(const ModelView& view, std::uint32_t layer, Visit visit) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const CouplingsView& couplings = view.level[q].couplings[layer];
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      const std::uint32_t column = view.level[q].domain_begin + j;
      visit_rows(couplings, j, 0, column,
                 [&](std::uint32_t row, std::uint32_t position) { visit(row, column, couplings, position); });
    }
  }
}

std::uint64_t blocks_of(const ModelView& view, std::uint32_t layer) {
  std::uint64_t blocks = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const CouplingsView& couplings = view.level[q].couplings[layer];
    blocks += couplings.begin[couplings.columns];
  }
  return blocks;
}

std::int16_t stored_as(const WideBlock&, int value) { return static_cast<std::int16_t>(value); }

std::uint16_t stored_as(const NarrowBlock&, int value) {
  const auto number = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  return static_cast<std::uint16_t>(bits >> 16);
}

// where element (r, c) of a block stands
constexpr std::uint32_t column_stride(const WideBlock&) { return 4; }
constexpr std::uint32_t column_stride(const NarrowBlock&) { return 3; }

// layers first..end-1, which share a quantum
struct Layers {
  std::uint32_t first;
  std::uint32_t end;
};

template <class Stored>
class Filling {
 public:
  Filling(const ModelView& view, const Layers& layers, const std::uint8_t* level, std::uint32_t* begin, Stored* blocks)
      : view_(view), layers_(layers), level_(level), begin_(begin), blocks_(blocks) {}

  void run() {
    const std::size_t lists = std::size_t{view_.domain_count} * view_.levels;
    std::memset(begin_, 0, sizeof(std::uint32_t) * (lists + 1));
    for (std::uint32_t layer = layers_.first; layer < layers_.end; ++layer) {
      visit_layer(view_, layer, [this](std::uint32_t row, std::uint32_t column, const CouplingsView&, std::uint32_t) {
        ++begin_[list(row, column) + 1];
        ++begin_[list(column, row) + 1];
      });
    }
    for (std::size_t k = 0; k < lists; ++k) {
      begin_[k + 1] += begin_[k];
    }
    for (std::uint32_t layer = layers_.first; layer < layers_.end; ++layer) {
      const std::uint32_t bits = layout::layer[layer].value_bits;
      visit_layer(view_, layer,
                  [&](std::uint32_t row, std::uint32_t column, const CouplingsView& from, std::uint32_t position) {
                    append(column, row, [&](std::uint32_t r, std::uint32_t c) {
                      return stored_value(from, bits, position, 3 * c + r);
                    });
                    append(row, column, [&](std::uint32_t r, std::uint32_t c) {
                      return stored_value(from, bits, position, 3 * r + c);
                    });
                  });
    }
    for (std::size_t k = lists; k > 0; --k) {
      begin_[k] = begin_[k - 1];
    }
    begin_[0] = 0;
  }

 private:
  [[nodiscard]] std::size_t list(std::uint32_t source, std::uint32_t target) const {
    return std::size_t{source} * view_.levels + level_[target];
  }

  template <class Element>
  void append(std::uint32_t source, std::uint32_t target, Element element) {
    const LevelView& level = view_.level[level_[target]];
    const std::uint32_t node = level.node_begin + (target - level.domain_begin);
    Stored& to = blocks_[begin_[list(source, target)]++];
    to = {};
    to.byte_offset = node * static_cast<std::uint32_t>(sizeof(Float4));
    for (std::uint32_t c = 0; c < 3; ++c) {
      for (std::uint32_t r = 0; r < 3; ++r) {
        to.value[column_stride(to) * c + r] = stored_as(to, element(r, c));
      }
    }
  }

  const ModelView& view_;
  Layers layers_;
  const std::uint8_t* level_;
  std::uint32_t* begin_;
  Stored* blocks_;
};

template <class Stored>
FieldLists<Stored> place_lists(Arena& arena, const ModelView& view, const Layers& layers, const std::uint8_t* level) {
  std::uint64_t count = 0;
  for (std::uint32_t layer = layers.first; layer < layers.end; ++layer) {
    count += 2 * blocks_of(view, layer);
  }
  auto* begin = arena.take<std::uint32_t>(std::uint64_t{view.domain_count} * view.levels + 1);
  auto* blocks = arena.take<Stored>(count);
  if (begin != nullptr) {
    Filling<Stored>(view, layers, level, begin, blocks).run();
  }
  return {view.info->quantum[layers.first] * Stored::widening, begin, blocks};
}

Block load(const WideBlock& block) {
  detail::Half8 low;
  detail::Half8 high;
  std::memcpy(&low, &block, sizeof low);
  std::memcpy(&high, block.value + 4, sizeof high);
  return {{detail::high_halves(low), detail::low_halves(high), detail::high_halves(high)}};
}

// fourth lanes: any of the block's values, or 0
Block load(const NarrowBlock& block) {
  return {{detail::load_upper_halves(block.value), detail::load_upper_halves(block.value + 3),
           detail::load_upper_halves(block.value + 6)}};
}

template <class Stored>
void add_lists(const FieldLists<Stored>& lists, std::size_t first, std::size_t end, Float4 force, Float4* x) {
  const Float4 scaled = without_denormals(force * splat(lists.factor));
  const Float4 f[3] = {splat3(scaled[0]), splat3(scaled[1]), splat3(scaled[2])};
  const Stored* const last = lists.block + lists.begin[end];
  for (const Stored* at = lists.block + lists.begin[first]; at != last; ++at) {
    *reinterpret_cast<Float4*>(reinterpret_cast<std::byte*>(x) + at->byte_offset) += product(load(*at), f);
  }
}

}  // namespace

FieldCouplings place_field_couplings(Arena& arena, const ModelView& view, const std::uint8_t* level) noexcept {
  FieldCouplings couplings;
  couplings.levels = view.levels;
  couplings.wide = place_lists<WideBlock>(arena, view, {0, 1}, level);
  const bool together = view.info->quantum[1] == view.info->quantum[2];
  couplings.narrow_lists = together ? 1 : 2;
  couplings.narrow[0] = place_lists<NarrowBlock>(arena, view, {1, together ? 3U : 2U}, level);
  if (!together) {
    couplings.narrow[1] = place_lists<NarrowBlock>(arena, view, {2, 3}, level);
  }
  return couplings;
}

void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  __builtin_prefetch(couplings.wide.block + couplings.wide.begin[first]);
  __builtin_prefetch(couplings.narrow[0].block + couplings.narrow[0].begin[first]);
}

void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const std::size_t end = first + field_level + 1;
  add_lists(couplings.wide, first, end, force, x);
  for (std::uint32_t n = 0; n < couplings.narrow_lists; ++n) {
    add_lists(couplings.narrow[n], first, end, force, x);
  }
}

}  // namespace greenloop
