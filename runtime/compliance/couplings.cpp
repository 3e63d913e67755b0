#include "runtime/compliance/couplings.hpp"

#include <algorithm>
#include <cstddef>

#include "runtime/algebra/stored_block.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

template <class Index>
std::uint32_t choose(const Index* index, std::uint32_t begin, std::uint32_t end, const std::uint32_t* slot,
                     std::uint32_t slots, BlockPlace* chosen) {
  std::uint32_t count = 0;
  for (std::uint32_t position = begin; position < end; ++position) {
    const std::uint32_t target = slot[index[position]];
    chosen[count] = {target, position};
    count += target < slots ? 1 : 0;
  }
  return count;
}

// some coefficients of one level, and their blocks with others
struct Window {
  static constexpr std::uint32_t most = 1024;
  std::uint32_t level;
  std::uint32_t first;
  std::uint32_t end;
  std::uint32_t blocks[most];
};

// those in their own columns
void count_own(const ModelView& view, std::uint32_t layer, LevelRange others, Window& window) {
  const LevelView& level = view.level[window.level];
  for (std::uint32_t j = window.first; j < window.end; ++j) {
    std::uint32_t& blocks = window.blocks[j - window.first];
    const std::uint32_t own = j - level.domain_begin;
    if (others.first == 0 && others.last >= window.level) {
      blocks += column_length(level.couplings[layer], own);
    } else {
      visit_rows(level.couplings[layer], own, view.level[others.first].domain_begin, domain_up_to(view, others.last),
                 [&](std::uint32_t, std::uint32_t) { ++blocks; });
    }
  }
}

// those in the columns of another level
void count_rows(const ModelView& view, std::uint32_t layer, std::uint32_t other, std::uint32_t in_tiles,
                Window& window) {
  const CouplingsView& couplings = view.level[other].couplings[layer];
  for (std::uint32_t j = 0; j < couplings.columns; ++j) {
    visit_rows(couplings, j, std::max(window.first, in_tiles), window.end,
               [&](std::uint32_t row, std::uint32_t) { ++window.blocks[row - window.first]; });
  }
}

}  // namespace

template <unsigned N>
float block_factor(const layout::Info& info, std::uint32_t layer) noexcept {
  float widening = 0;
  with_stored<N>(layout::value_bits[layer], [&](auto stored) { widening = decltype(stored)::widening; });
  return info.quantum[layer] * widening;
}

template <unsigned N>
std::uint32_t load_slotted(const CouplingsView& view, std::uint32_t layer, std::uint32_t column,
                           const std::uint32_t* slot, std::uint32_t slots, BlockPlace* places,
                           Block<N>* blocks) noexcept {
  if (view.columns == 0) {
    return 0;
  }
  const std::uint32_t begin = view.begin[column];
  const std::uint32_t end = view.begin[column + 1];
  const std::uint32_t count =
      view.index_bytes == 2 ? choose(static_cast<const std::uint16_t*>(view.index), begin, end, slot, slots, places)
                            : choose(static_cast<const std::uint32_t*>(view.index), begin, end, slot, slots, places);
  with_stored<N>(layout::value_bits[layer], [&](auto stored) {
    using Stored = decltype(stored);
    for (std::uint32_t n = 0; n < count; ++n) {
      blocks[n] = Stored::load(view.value + Stored::bytes * std::size_t{places[n].position});
    }
  });
  return count;
}

CouplingCounts count_couplings(const ModelView& view) noexcept {
  CouplingCounts counts;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (const CouplingsView& couplings : view.level[q].couplings) {
      for (std::uint32_t j = 0; j < couplings.columns; ++j) {
        counts.longest_column = std::max(counts.longest_column, column_length(couplings, j));
      }
    }
  }
  counts.countable = block_count(view, 0, layout::layers) < std::uint64_t{1} << 30;
  return counts;
}

void count_stored(const ModelView& view, std::uint32_t q, ValueCounts<>& counts) noexcept {
  for (std::uint32_t j = 0; j < view.level[q].counts->domain_count; ++j) {
    std::uint32_t stored = 0;
    for (const CouplingsView& couplings : view.level[q].couplings) {
      stored += column_length(couplings, j);
    }
    counts.add(stored);
  }
}

void count_blocks(const ModelView& view, std::uint32_t q, LevelRange others, const BaseColumns& base,
                  ValueCounts<>& counts) noexcept {
  const std::uint32_t end = domain_up_to(view, q);
  for (std::uint32_t first = view.level[q].domain_begin; first < end; first += Window::most) {
    Window window{q, first, std::min(first + Window::most, end), {}};
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      count_own(view, layer, others, window);
      for (std::uint32_t with = std::max(q, others.first); with <= others.last; ++with) {
        count_rows(view, layer, with, base.holds[layer] ? base.columns : 0, window);
      }
    }
    std::for_each(window.blocks, window.blocks + (window.end - first), [&](std::uint32_t n) { counts.add(n); });
  }
}

template float block_factor<1>(const layout::Info&, std::uint32_t) noexcept;
template float block_factor<3>(const layout::Info&, std::uint32_t) noexcept;
template std::uint32_t load_slotted<1>(const CouplingsView&, std::uint32_t, std::uint32_t, const std::uint32_t*,
                                       std::uint32_t, BlockPlace*, Block<1>*) noexcept;
template std::uint32_t load_slotted<3>(const CouplingsView&, std::uint32_t, std::uint32_t, const std::uint32_t*,
                                       std::uint32_t, BlockPlace*, Block<3>*) noexcept;

}  // namespace greenloop
