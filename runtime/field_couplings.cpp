#include "runtime/field_couplings.hpp"

#include <bit>
#include <cstring>

#include "formats/field_value.hpp"
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

// the field layers of one quantum
class LayerGroup {
 public:
  LayerGroup(const ModelView& view, float quantum) : view_(view), quantum_(quantum) {}

  [[nodiscard]] bool has(std::uint32_t layer) const { return view_.info->quantum[layer] == quantum_; }

  [[nodiscard]] std::uint64_t blocks() const {
    std::uint64_t blocks = 0;
    for (std::uint32_t layer = 0; layer < layout::field_layers; ++layer) {
      for (std::uint32_t q = 0; has(layer) && q < view_.levels; ++q) {
        const CouplingsView& couplings = view_.level[q].couplings[layer];
        blocks += std::uint64_t{2} * couplings.begin[couplings.columns];
      }
    }
    return blocks;
  }

  void fill(const std::uint8_t* level, std::uint32_t* begin, FieldBlock* blocks) const {
    const std::size_t lists = std::size_t{view_.domain_count} * view_.levels;
    const auto list = [&](std::uint32_t source, std::uint32_t target) {
      return std::size_t{source} * view_.levels + level[target];
    };
    std::memset(begin, 0, sizeof(std::uint32_t) * (lists + 1));
    visit_group([&](std::uint32_t, std::uint32_t row, std::uint32_t column, const CouplingsView&, std::uint32_t) {
      ++begin[list(row, column) + 1];
      ++begin[list(column, row) + 1];
    });
    for (std::size_t k = 0; k < lists; ++k) {
      begin[k + 1] += begin[k];
    }
    visit_group([&](std::uint32_t layer, std::uint32_t row, std::uint32_t column, const CouplingsView& from,
                    std::uint32_t position) {
      FieldBlock& direct = blocks[begin[list(column, row)]++];
      FieldBlock& mirrored = blocks[begin[list(row, column)]++];
      direct = {.byte_offset = byte_offset(level[row], row), .value = {}, .zero = 0};
      mirrored = {.byte_offset = byte_offset(level[column], column), .value = {}, .zero = 0};
      for (std::uint32_t k = 0; k < 9; ++k) {
        const int element = stored_value(from, layout::layer[layer].value_bits, position, k);
        direct.value[k] = mirrored.value[3 * (k % 3) + k / 3] =
            static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(field_value(element)) >> 16);
      }
    });
    std::memmove(begin + 1, begin, sizeof(std::uint32_t) * lists);
    begin[0] = 0;
  }

 private:
  template <class Visit>
  void visit_group(Visit visit) const {
    for (std::uint32_t layer = 0; layer < layout::field_layers; ++layer) {
      if (has(layer)) {
        visit_layer(view_, layer,
                    [&](std::uint32_t row, std::uint32_t column, const CouplingsView& from, std::uint32_t position) {
                      visit(layer, row, column, from, position);
                    });
      }
    }
  }

  [[nodiscard]] std::uint32_t byte_offset(std::uint8_t q, std::uint32_t coefficient) const {
    const LevelView& level = view_.level[q];
    return (coefficient - level.domain_begin + level.node_begin) * static_cast<std::uint32_t>(sizeof(Float4));
  }

  const ModelView& view_;
  float quantum_;
};

// fourth lanes: any of the block's values, or 0
Block load(const FieldBlock& block) {
  return {{detail::load_upper_halves(block.value), detail::load_upper_halves(block.value + 3),
           detail::load_upper_halves(block.value + 6)}};
}

}  // namespace

FieldCouplings place_field_couplings(Arena& arena, const ModelView& view, const std::uint8_t* level) noexcept {
  FieldCouplings couplings;
  couplings.levels = view.levels;
  for (std::uint32_t layer = 0; layer < layout::field_layers; ++layer) {
    const float quantum = view.info->quantum[layer];
    bool known = false;
    for (std::uint32_t n = 0; n < couplings.quanta; ++n) {
      known = known || couplings.of_quantum[n].quantum == quantum;
    }
    if (known) {
      continue;
    }
    const LayerGroup group(view, quantum);
    auto* begin = arena.take<std::uint32_t>(std::uint64_t{view.domain_count} * view.levels + 1);
    auto* blocks = arena.take<FieldBlock>(group.blocks());
    if (begin != nullptr) {
      group.fill(level, begin, blocks);
    }
    couplings.of_quantum[couplings.quanta++] = {quantum, begin, blocks};
  }
  return couplings;
}

void prefetch_couplings(const FieldCouplings& couplings, std::uint32_t coefficient) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  for (std::uint32_t n = 0; n < couplings.quanta; ++n) {
    __builtin_prefetch(couplings.of_quantum[n].block + couplings.of_quantum[n].begin[first]);
  }
}

void add_couplings(const FieldCouplings& couplings, std::uint32_t coefficient, std::uint32_t field_level, Float4 force,
                   Float4* x) noexcept {
  const std::size_t first = std::size_t{coefficient} * couplings.levels;
  const std::size_t end = first + field_level + 1;
  for (std::uint32_t n = 0; n < couplings.quanta; ++n) {
    const FieldLists& lists = couplings.of_quantum[n];
    const Float4 scaled = without_denormals(force * splat(lists.quantum));
    const Float4 f[3] = {splat3(scaled[0]), splat3(scaled[1]), splat3(scaled[2])};
    const FieldBlock* const last = lists.block + lists.begin[end];
    for (const FieldBlock* at = lists.block + lists.begin[first]; at != last; ++at) {
      *reinterpret_cast<Float4*>(reinterpret_cast<std::byte*>(x) + at->byte_offset) += product(load(*at), f);
    }
  }
}

}  // namespace greenloop
