#include "runtime/couplings.hpp"

#include <cstddef>

namespace greenloop {
namespace {

// lists of blocks as their n-th target and position

struct EveryRow {
  std::uint32_t begin;
  BlockPlace operator[](std::uint32_t n) const { return {n, begin + n}; }
};

template <class Index>
struct SomeRows {
  const Index* index;
  std::uint32_t begin;
  BlockPlace operator[](std::uint32_t n) const { return {index[n], begin + n}; }
};

// calls visit(list, length) with the blocks of a column
template <class Visit>
void with_column(const CouplingsView& view, std::uint32_t column, Visit visit) {
  const std::uint32_t begin = view.begin[column];
  const std::uint32_t length = view.begin[column + 1] - begin;
  if (view.index_bytes == 0) {
    visit(EveryRow{begin}, length);
  } else if (view.index_bytes == 2) {
    visit(SomeRows<std::uint16_t>{static_cast<const std::uint16_t*>(view.index) + begin, begin}, length);
  } else {
    visit(SomeRows<std::uint32_t>{static_cast<const std::uint32_t*>(view.index) + begin, begin}, length);
  }
}

// calls visit(the stored type) for the section's bits per value
template <class Visit>
void with_values(const CouplingsView& view, Visit visit) {
  if (view.value_bits == 4) {
    visit(StoredBlock<4>{});
  } else if (view.value_bits == 8) {
    visit(StoredBlock<8>{});
  } else {
    visit(StoredBlock<16>{});
  }
}

template <bool mirror, class Stored>
Block load(const CouplingsView& view, std::uint32_t position) {
  const Block block = Stored::load(view.value + Stored::bytes * std::size_t{position});
  return mirror ? transposed(block) : block;
}

template <bool mirror, class Stored, class List>
void add_list(const CouplingsView& view, List list, std::uint32_t length, Float4 force, Float4* sums) {
  const Float4 f[3] = {splat3(force[0]), splat3(force[1]), splat3(force[2])};
  for (std::uint32_t n = 0; n < length; ++n) {
    const BlockPlace place = list[n];
    sums[place.target] += product(load<mirror, Stored>(view, place.position), f);
  }
}

template <class List>
std::uint32_t choose(List list, std::uint32_t length, const std::uint32_t* slot, BlockPlace* chosen) {
  std::uint32_t count = 0;
  for (std::uint32_t n = 0; n < length; ++n) {
    const BlockPlace place = list[n];
    chosen[count] = {slot[place.target], place.position};
    count += slot[place.target] != layout::none ? 1 : 0;
  }
  return count;
}

void prefetch_lines(const void* data, std::size_t begin, std::size_t size) {
  constexpr std::size_t line = 64;
  const auto* bytes = static_cast<const char*>(data) + begin;
  for (std::size_t at = 0; at < size; at += line) {
    __builtin_prefetch(bytes + at);
  }
}

std::size_t block_bytes(const CouplingsView& view) {
  return view.value_bits == 4 ? StoredBlock<4>::bytes
                              : (view.value_bits == 8 ? StoredBlock<8>::bytes : StoredBlock<16>::bytes);
}

float widening(const CouplingsView& view) {
  return view.value_bits == 4 ? StoredBlock<4>::widening
                              : (view.value_bits == 8 ? StoredBlock<8>::widening : StoredBlock<16>::widening);
}

// calls visit(column, row, position) for every block, by columns
template <class Visit>
void visit_blocks(const CouplingsView& view, Visit visit) {
  for (std::uint32_t j = 0; j < view.columns; ++j) {
    with_column(view, j, [&](auto list, std::uint32_t length) {
      for (std::uint32_t n = 0; n < length; ++n) {
        visit(j, list[n].target, list[n].position);
      }
    });
  }
}

void mirror(const CouplingsView& view, std::uint32_t* begin, BlockPlace* blocks) {
  for (std::uint32_t i = 0; i <= view.rows; ++i) {
    begin[i] = 0;
  }
  visit_blocks(view, [&](std::uint32_t, std::uint32_t row, std::uint32_t) { ++begin[row + 1]; });
  for (std::uint32_t i = 0; i < view.rows; ++i) {
    begin[i + 1] += begin[i];
  }
  visit_blocks(view, [&](std::uint32_t column, std::uint32_t row, std::uint32_t position) {
    blocks[begin[row]++] = {column, position};
  });
  for (std::uint32_t i = view.rows; i > 0; --i) {
    begin[i] = begin[i - 1];
  }
  begin[0] = 0;
}

}  // namespace

bool find_section(const ModelView& view, std::uint32_t n, CouplingSection& section) noexcept {
  const std::uint32_t layer = n % layout::strengths;
  const std::uint32_t partner = n / layout::strengths % 3;
  const std::uint32_t q = n / (3 * layout::strengths);
  if (q >= view.levels) {
    return false;
  }
  const CouplingsView& of = view.level[q].couplings[partner][layer];
  if (of.columns == 0 || of.begin[of.columns] == 0) {
    return false;
  }
  constexpr auto averages = static_cast<std::uint32_t>(layout::Partner::averages);
  constexpr auto parents = static_cast<std::uint32_t>(layout::Partner::parents);
  section = {};
  section.view = of;
  section.column_group = Coefficients::details(q);
  section.column_level = q;
  section.row_level = partner == averages ? (q < 2 ? 0 : q - 2) : (partner == parents ? q - 1 : q);
  section.row_group =
      partner == averages ? Coefficients::averages(section.row_level) : Coefficients::details(section.row_level);
  section.layer = layer;
  section.factor = of.quantum * widening(of);
  return true;
}

Couplings place_couplings(Arena& arena, const ModelView& view) noexcept {
  Couplings couplings;
  CouplingSection section;
  for (std::uint32_t n = 0; n < Couplings::most; ++n) {
    couplings.count += find_section(view, n, section) ? 1 : 0;
  }
  auto* sections = arena.take<CouplingSection>(couplings.count);
  couplings.section = sections;
  for (std::uint32_t n = 0; n < Couplings::most; ++n) {
    if (!find_section(view, n, section)) {
      continue;
    }
    auto* begin = arena.take<std::uint32_t>(section.view.rows + std::uint64_t{1});
    auto* blocks = arena.take<BlockPlace>(section.view.begin[section.view.columns]);
    if (sections != nullptr) {
      mirror(section.view, begin, blocks);
      section.mirrored_begin = begin;
      section.mirrored = blocks;
      *sections++ = section;
    }
  }
  return couplings;
}

LongestLists longest_lists(const CouplingSection& section) noexcept {
  constexpr std::uint32_t at_once = 1024;
  LongestLists longest;
  for (std::uint32_t j = 0; j < section.view.columns; ++j) {
    const std::uint32_t length = section.direct_length(j);
    longest.direct = length > longest.direct ? length : longest.direct;
  }
  for (std::uint32_t first = 0; first < section.view.rows; first += at_once) {
    std::uint32_t lengths[at_once] = {};
    visit_blocks(section.view, [&](std::uint32_t, std::uint32_t row, std::uint32_t) {
      if (row - first < at_once) {
        ++lengths[row - first];
      }
    });
    for (const std::uint32_t length : lengths) {
      longest.mirrored = length > longest.mirrored ? length : longest.mirrored;
    }
  }
  return longest;
}

void add_direct(const CouplingSection& section, std::uint32_t column, Float4 force, Float4* rows) noexcept {
  with_values(section.view, [&](auto stored) {
    with_column(section.view, column, [&](auto list, std::uint32_t length) {
      add_list<false, decltype(stored)>(section.view, list, length, force, rows);
    });
  });
}

void add_mirrored(const CouplingSection& section, std::uint32_t row, Float4 force, Float4* columns) noexcept {
  with_values(section.view, [&](auto stored) {
    add_list<true, decltype(stored)>(section.view, section.mirrored + section.mirrored_begin[row],
                                     section.mirrored_length(row), force, columns);
  });
}

void prefetch_direct(const CouplingSection& section, std::uint32_t column) noexcept {
  const CouplingsView& view = section.view;
  const std::size_t begin = view.begin[column];
  const std::size_t length = section.direct_length(column);
  prefetch_lines(view.value, block_bytes(view) * begin, block_bytes(view) * length);
  prefetch_lines(view.index, view.index_bytes * begin, view.index_bytes * length);
}

void prefetch_mirrored(const CouplingSection& section, std::uint32_t row) noexcept {
  const std::size_t begin = section.mirrored_begin[row];
  prefetch_lines(section.mirrored, sizeof(BlockPlace) * begin, sizeof(BlockPlace) * section.mirrored_length(row));
}

std::uint32_t load_slotted(const CouplingSection& section, std::uint32_t column, const std::uint32_t* slot,
                           BlockPlace* places, Block* blocks) noexcept {
  std::uint32_t count = 0;
  with_column(section.view, column,
              [&](auto list, std::uint32_t length) { count = choose(list, length, slot, places); });
  with_values(section.view, [&](auto stored) {
    for (std::uint32_t n = 0; n < count; ++n) {
      blocks[n] = load<false, decltype(stored)>(section.view, places[n].position);
    }
  });
  return count;
}

}  // namespace greenloop
