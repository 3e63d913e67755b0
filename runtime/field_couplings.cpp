#include "runtime/field_couplings.hpp"

#include <bit>
#include <cstring>

#include "formats/field_block.hpp"
#include "formats/stored_blocks.hpp"
#include "runtime/couplings.hpp"
#include "runtime/domain.hpp"

namespace greenloop {
namespace {

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

// calls visit(layer, row, column, section, position) for every block of the field, by layers, then by columns
template <class Visit>
void visit_field(const ModelView& view, Visit visit) {
  for (std::uint32_t layer = 0; layer < layout::field_layers; ++layer) {
    visit_layer(view, layer,
                [&](std::uint32_t row, std::uint32_t column, const CouplingsView& from, std::uint32_t position) {
                  visit(layer, row, column, from, position);
                });
  }
}

const layout::Scale& scale_of(const ModelView& view, const std::uint8_t* level, std::uint32_t coefficient) {
  const LevelView& at = view.level[level[coefficient]];
  return at.scales[coefficient - at.domain_begin];
}

std::uint32_t byte_offset(const ModelView& view, const std::uint8_t* level, std::uint32_t coefficient) {
  const LevelView& at = view.level[level[coefficient]];
  return (coefficient - at.domain_begin + at.node_begin) * static_cast<std::uint32_t>(sizeof(Float4));
}

// R D R
OwnBlock own_block(const layout::Scale& scale) {
  OwnBlock own;
  std::uint32_t k = 0;
  for (std::uint32_t r = 0; r < 3; ++r) {
    for (std::uint32_t c = r; c < 3; ++c) {
      double sum = 0;
      for (std::uint32_t a = 0; a < 3; ++a) {
        for (std::uint32_t b = 0; b < 3; ++b) {
          sum += double{symmetric_element(scale.root, r, a)} * double{symmetric_element(scale.diagonal, a, b)} *
                 double{symmetric_element(scale.root, b, c)};
        }
      }
      own.element[k++] = static_cast<float>(sum);
    }
  }
  return own;
}

void fill(const ModelView& view, const std::uint8_t* level, std::uint32_t* begin, FieldBlock* blocks) {
  const std::size_t lists = std::size_t{view.domain_count} * view.levels;
  const std::uint32_t halves = field_halves(*view.info);
  const auto list = [&](std::uint32_t source, std::uint32_t target) {
    return std::size_t{source} * view.levels + level[target];
  };
  std::memset(begin, 0, sizeof(std::uint32_t) * (lists + 1));
  visit_field(view, [&](std::uint32_t, std::uint32_t row, std::uint32_t column, const CouplingsView&, std::uint32_t) {
    begin[list(row, column) + 1] += halves;
    begin[list(column, row) + 1] += halves;
  });
  for (std::size_t k = 0; k < lists; ++k) {
    begin[k + 1] += begin[k];
  }
  visit_field(view, [&](std::uint32_t layer, std::uint32_t row, std::uint32_t column, const CouplingsView& from,
                        std::uint32_t position) {
    const auto element = [&](std::uint32_t k) {
      return stored_value(from, layout::layer[layer].value_bits, position, k);
    };
    float value[9];
    field_block(scale_of(view, level, row), scale_of(view, level, column), view.info->quantum[layer], element, value);
    for (std::uint32_t n = 0; n < halves; ++n) {
      FieldBlock& direct = blocks[begin[list(column, row)]++];
      FieldBlock& mirrored = blocks[begin[list(row, column)]++];
      direct = {.byte_offset = byte_offset(view, level, row), .value = {}, .zero = 0};
      mirrored = {.byte_offset = byte_offset(view, level, column), .value = {}, .zero = 0};
      for (std::uint32_t k = 0; k < 9; ++k) {
        const float half = upper_half(value[k]);
        direct.value[k] = mirrored.value[3 * (k % 3) + k / 3] =
            static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(half) >> 16);
        value[k] -= half;
      }
    }
  });
  std::memmove(begin + 1, begin, sizeof(std::uint32_t) * lists);
  begin[0] = 0;
}

constexpr std::ptrdiff_t most_prefetched = 1024;  // bytes of a list; the rest follows by itself

// fourth lanes: any of the block's values, or 0
Block load(const FieldBlock& block) {
  return {{detail::load_upper_halves(block.value), detail::load_upper_halves(block.value + 3),
           detail::load_upper_halves(block.value + 6)}};
}

}  // namespace

FieldCouplings place_field_couplings(Arena& arena, const ModelView& view, const std::uint8_t* level) noexcept {
  auto* own = arena.take<OwnBlock>(view.domain_count);
  auto* begin = arena.take<std::uint32_t>(std::uint64_t{view.domain_count} * view.levels + 1);
  auto* blocks =
      arena.take<FieldBlock>(std::uint64_t{2} * field_halves(*view.info) * block_count(view, 0, layout::field_layers));
  if (own != nullptr) {
    for (std::uint32_t i = 0; i < view.domain_count; ++i) {
      own[i] = own_block(scale_of(view, level, i));
    }
    fill(view, level, begin, blocks);
  }
  return {view.levels, own, begin, blocks};
}

void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept {
  const std::uint32_t* begin = couplings.begin + std::size_t{coefficient} * couplings.levels;
  const auto* at = reinterpret_cast<const std::byte*>(couplings.block + begin[0]);
  const auto* end = reinterpret_cast<const std::byte*>(couplings.block + begin[couplings.levels]);
  end = end - at > most_prefetched ? at + most_prefetched : end;
  for (; at < end; at += 64) {
    __builtin_prefetch(at);
  }
}

void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const Float4 f[3] = {splat3(force[0]), splat3(force[1]), splat3(force[2])};
  const FieldBlock* const last = couplings.block + couplings.begin[first + field_level + 1];
  for (const FieldBlock* at = couplings.block + couplings.begin[first]; at != last; ++at) {
    *reinterpret_cast<Float4*>(reinterpret_cast<std::byte*>(x) + at->byte_offset) += product(load(*at), f);
  }
}

}  // namespace greenloop
