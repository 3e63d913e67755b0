#include "runtime/compliance/couplings.hpp"

#include <algorithm>
#include <cstddef>

#include "runtime/algebra/stored_block.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// calls visit(the stored type) for the bits of a value
template <unsigned N, class Visit>
void with_stored(std::uint32_t value_bits, Visit visit) {
  if (value_bits == 4) {
    visit(StoredBlock<N, 4>{});
  } else if (value_bits == 8) {
    visit(StoredBlock<N, 8>{});
  } else {
    visit(StoredBlock<N, 16>{});
  }
}

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

// some coefficients of one level, and their blocks with another level
struct Window {
  static constexpr std::uint32_t most = 512;
  std::uint32_t level;
  std::uint32_t first;
  std::uint32_t end;
  std::uint32_t stored[most];
};

void count_with_level(const ModelView& view, std::uint32_t other, Window& window) {
  std::fill(window.stored, window.stored + Window::most, 0U);
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const auto count = [&](std::uint32_t place) { ++window.stored[place - window.first]; };
    if (other <= window.level) {
      const LevelView& own = view.level[window.level];
      for (std::uint32_t j = window.first; j < window.end; ++j) {
        visit_rows(own.couplings[layer], j - own.domain_begin, view.level[other].domain_begin,
                   domain_up_to(view, other), [&](std::uint32_t, std::uint32_t) { count(j); });
      }
    }
    for (std::uint32_t j = 0; other >= window.level && j < view.level[other].counts->domain_count; ++j) {
      visit_rows(view.level[other].couplings[layer], j, window.first, window.end,
                 [&](std::uint32_t row, std::uint32_t) { count(row); });
    }
  }
}

void add_counts(const std::uint32_t* counts, std::uint32_t size, LevelPair& pair) {
  for (std::uint32_t i = 0; i < size; ++i) {
    pair.all += counts[i];
    pair.most = std::max(pair.most, counts[i]);
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
  for (std::uint32_t q = 0; counts.countable && q < view.levels; ++q) {
    const std::uint32_t end = domain_up_to(view, q);
    for (std::uint32_t first = view.level[q].domain_begin; first < end; first += Window::most) {
      Window window;
      window.level = q;
      window.first = first;
      window.end = std::min(first + Window::most, end);
      for (std::uint32_t other = 0; other < view.levels; ++other) {
        count_with_level(view, other, window);
        add_counts(window.stored, window.end - first, counts.stored[q][other]);
      }
    }
  }
  return counts;
}

template float block_factor<1>(const layout::Info&, std::uint32_t) noexcept;
template float block_factor<3>(const layout::Info&, std::uint32_t) noexcept;
template std::uint32_t load_slotted<1>(const CouplingsView&, std::uint32_t, std::uint32_t, const std::uint32_t*,
                                       std::uint32_t, BlockPlace*, Block<1>*) noexcept;
template std::uint32_t load_slotted<3>(const CouplingsView&, std::uint32_t, std::uint32_t, const std::uint32_t*,
                                       std::uint32_t, BlockPlace*, Block<3>*) noexcept;

}  // namespace greenloop
