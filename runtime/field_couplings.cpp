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

template <class Stored>
class Filling {
 public:
  Filling(const ModelView& view, std::uint32_t layer, const std::uint8_t* level, std::uint32_t* begin, Stored* blocks)
      : view_(view), layer_(layer), level_(level), begin_(begin), blocks_(blocks) {}

  void run() {
    const std::size_t lists = std::size_t{view_.domain_count} * view_.levels;
    for (std::size_t k = 0; k <= lists; ++k) {
      begin_[k] = 0;
    }
    visit_layer(view_, layer_, [this](std::uint32_t row, std::uint32_t column, const CouplingsView&, std::uint32_t) {
      ++begin_[list(row, column) + 1];
      ++begin_[list(column, row) + 1];
    });
    for (std::size_t k = 0; k < lists; ++k) {
      begin_[k + 1] += begin_[k];
    }
    visit_layer(view_, layer_,
                [this](std::uint32_t row, std::uint32_t column, const CouplingsView& from, std::uint32_t position) {
                  append(column, row, from, position, 3, 1);
                  append(row, column, from, position, 1, 3);
                });
    for (std::size_t k = lists; k > 0; --k) {
      begin_[k] = begin_[k - 1];
    }
    begin_[0] = 0;
  }

 private:
  [[nodiscard]] std::size_t list(std::uint32_t source, std::uint32_t target) const {
    return std::size_t{source} * view_.levels + level_[target];
  }

  void append(std::uint32_t source, std::uint32_t target, const CouplingsView& from, std::uint32_t position,
              std::uint32_t column_stride, std::uint32_t row_stride) {
    const LevelView& level = view_.level[level_[target]];
    const std::uint32_t node = level.node_begin + (target - level.domain_begin);
    Stored& to = blocks_[begin_[list(source, target)]++];
    to = {};
    to.byte_offset = node * static_cast<std::uint32_t>(sizeof(Float4));
    for (std::uint32_t c = 0; c < 3; ++c) {
      for (std::uint32_t r = 0; r < 3; ++r) {
        const int value =
            stored_value(from, layout::layer[layer_].value_bits, position, column_stride * c + row_stride * r);
        to.value[4 * c + r] = static_cast<std::remove_reference_t<decltype(to.value[0])>>(value);
      }
    }
  }

  const ModelView& view_;
  std::uint32_t layer_;
  const std::uint8_t* level_;
  std::uint32_t* begin_;
  Stored* blocks_;
};

template <class Stored>
void place_layer(Arena& arena, const ModelView& view, std::uint32_t layer, const std::uint8_t* level,
                 FieldLayer<Stored>& lists) {
  auto* begin = arena.take<std::uint32_t>(std::uint64_t{view.domain_count} * view.levels + 1);
  auto* blocks = arena.take<Stored>(2 * blocks_of(view, layer));
  lists = {view.info->quantum[layer] * Stored::widening, begin, blocks};
  if (begin != nullptr) {
    Filling<Stored>(view, layer, level, begin, blocks).run();
  }
}

Block load(const HalfBlock& block) {
  detail::Half8 low;
  detail::Half8 high;
  std::memcpy(&low, &block, sizeof low);
  std::memcpy(&high, block.value + 4, sizeof high);
  return {{detail::high_halves(low), detail::low_halves(high), detail::high_halves(high)}};
}

Block load(const ByteBlock& block) {
  detail::Byte16 bytes;
  std::memcpy(&bytes, &block, sizeof bytes);
  const auto low = reinterpret_cast<detail::Half8>(
      __builtin_shufflevector(detail::Byte16{}, bytes, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
  const auto high = reinterpret_cast<detail::Half8>(
      __builtin_shufflevector(detail::Byte16{}, bytes, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31));
  return {{detail::high_halves(low), detail::low_halves(high), detail::high_halves(high)}};
}

template <class Stored>
void add_layer(const FieldLayer<Stored>& layer, std::size_t first, std::size_t end, Float4 force, Float4* x) {
  const Float4 scaled = without_denormals(force * splat(layer.factor));
  const Float4 f[3] = {splat(scaled[0]), splat(scaled[1]), splat(scaled[2])};
  const Stored* const last = layer.block + layer.begin[end];
  for (const Stored* at = layer.block + layer.begin[first]; at != last; ++at) {
    *reinterpret_cast<Float4*>(reinterpret_cast<std::byte*>(x) + at->byte_offset) += product(load(*at), f);
  }
}

}  // namespace

FieldCouplings place_field_couplings(Arena& arena, const ModelView& view, const std::uint8_t* level) noexcept {
  FieldCouplings couplings;
  couplings.levels = view.levels;
  place_layer(arena, view, 0, level, couplings.halves);
  place_layer(arena, view, 1, level, couplings.bytes);
  place_layer(arena, view, 2, level, couplings.nibbles);
  return couplings;
}

void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  __builtin_prefetch(couplings.halves.block + couplings.halves.begin[first]);
  __builtin_prefetch(couplings.bytes.block + couplings.bytes.begin[first]);
  __builtin_prefetch(couplings.nibbles.block + couplings.nibbles.begin[first]);
}

void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const std::size_t end = first + field_level + 1;
  add_layer(couplings.halves, first, end, force, x);
  add_layer(couplings.bytes, first, end, force, x);
  add_layer(couplings.nibbles, first, end, force, x);
}

}  // namespace greenloop
