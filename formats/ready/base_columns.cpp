#include "formats/ready/base_columns.hpp"

#include "formats/stored_blocks.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t eight_bits = BaseColumns::quantum_layer;
constexpr std::uint32_t four_bits = 3;
constexpr std::uint32_t least_domain = 512;
static_assert(layout::value_bits[eight_bits] == 8 && layout::value_bits[four_bits] == 4);

std::uint32_t base_coefficients(const ElastostaticView& view) { return view.level[0].counts->domain_count; }

// calls visit(couplings, layer, row, column among all coefficients, position) for the blocks of level 0's rows
template <class Visit>
void visit_base(const ElastostaticView& view, const bool (&holds)[layout::layers], Visit visit) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = level.couplings[layer];
      for (std::uint32_t j = 0; holds[layer] && j < couplings.columns; ++j) {
        visit_rows(couplings, j, 0, base_coefficients(view), [&](std::uint32_t row, std::uint32_t position) {
          visit(couplings, layer, row, level.domain_begin + j, position);
        });
      }
    }
  }
}

// whether a block of level 0's rows has a part in both layers
bool share_blocks(const ElastostaticView& view) {
  bool shared = false;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const CouplingsView& other = view.level[q].couplings[eight_bits];
    const CouplingsView& couplings = view.level[q].couplings[four_bits];
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      visit_rows(couplings, j, 0, base_coefficients(view), [&](std::uint32_t row, std::uint32_t) {
        visit_rows(other, j, row, row + 1, [&](std::uint32_t, std::uint32_t) { shared = true; });
      });
    }
  }
  return shared;
}

}  // namespace

BaseColumns base_columns_of(const ElastostaticView& view) noexcept {
  BaseColumns base;
  base.holds[eight_bits] = true;
  base.holds[four_bits] = view.info->quantum[four_bits] == view.info->quantum[eight_bits] && !share_blocks(view);
  std::uint64_t blocks = 0;
  visit_base(view, base.holds,
             [&](const CouplingsView&, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t) { ++blocks; });
  const std::uint32_t columns = base_coefficients(view);
  const std::uint64_t all = std::uint64_t{columns} * tiles_of(view.domain_count) * BaseColumns::width;
  // tiles of fewer blocks take more memory and time than those, and short columns do not pay where there are no vectors
  if (4 * blocks < 3 * all || view.domain_count < least_domain) {
    return {};
  }
  base.columns = columns;
  base.tiles = tiles_of(view.domain_count);
  return base;
}

template <unsigned N>
void fill_base_columns(const ElastostaticView& view, const BaseColumns& base, std::byte* value) noexcept {
  visit_base(view, base.holds,
             [&](const CouplingsView& couplings, std::uint32_t layer, std::uint32_t row, std::uint32_t column,
                 std::uint32_t position) {
               std::byte* const tile =
                   value + BaseColumns::tile_bytes<N> * (std::size_t{base.tiles} * row + column / BaseColumns::width);
               for (std::uint32_t k = 0; k < N * N; ++k) {  // transposed
                 std::byte& element = tile[8 * (N * (k % N) + k / N) + column % BaseColumns::width];
                 const int stored = stored_value<N>(couplings, layout::value_bits[layer], position, k);
                 element = static_cast<std::byte>(static_cast<std::int8_t>(element) + stored);
               }
             });
}

template void fill_base_columns<1>(const ElastostaticView&, const BaseColumns&, std::byte*) noexcept;
template void fill_base_columns<3>(const ElastostaticView&, const BaseColumns&, std::byte*) noexcept;

}  // namespace greenloop
