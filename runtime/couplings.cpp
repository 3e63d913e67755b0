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

// the blocks of a column, or of a row

struct EveryColumn {
  const CouplingsView& view;
  EveryRow operator[](std::uint32_t j) const { return {view.begin[j]}; }
  [[nodiscard]] std::uint32_t length(std::uint32_t j) const { return view.begin[j + 1] - view.begin[j]; }
  void prefetch(std::uint32_t) const {}
};

template <class Index>
struct SomeColumns {
  const CouplingsView& view;
  SomeRows<Index> operator[](std::uint32_t j) const {
    return {static_cast<const Index*>(view.index) + view.begin[j], view.begin[j]};
  }
  [[nodiscard]] std::uint32_t length(std::uint32_t j) const { return view.begin[j + 1] - view.begin[j]; }
  void prefetch(std::uint32_t j) const { __builtin_prefetch(static_cast<const Index*>(view.index) + view.begin[j]); }
};

struct MirroredRows {
  const CouplingSection& section;
  const BlockPlace* operator[](std::uint32_t i) const { return section.mirrored + section.mirrored_begin[i]; }
  [[nodiscard]] std::uint32_t length(std::uint32_t i) const { return section.mirrored_length(i); }
  void prefetch(std::uint32_t i) const { __builtin_prefetch(section.mirrored + section.mirrored_begin[i]); }
};

// calls visit(the blocks by columns)
template <class Visit>
void with_columns(const CouplingsView& view, Visit visit) {
  if (view.index_bytes == 0) {
    visit(EveryColumn{view});
  } else if (view.index_bytes == 2) {
    visit(SomeColumns<std::uint16_t>{view});
  } else {
    visit(SomeColumns<std::uint32_t>{view});
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

bool zero(Float4 x) { return x[0] == 0 && x[1] == 0 && x[2] == 0; }

template <bool mirror, class Stored, class Lists>
void add_lists(const CouplingSection& section, const Lists& lists, const SparseGroup& from, Float4* to) {
  constexpr std::uint32_t ahead = 2;  // lists whose memory is on its way while one is summed
  const CouplingsView& view = section.view;
  for (std::uint32_t k = 0; k < from.count; ++k) {
    if (k + ahead < from.count) {
      const std::uint32_t soon = from.list[k + ahead] - from.begin;
      lists.prefetch(soon);
      if (!mirror) {
        __builtin_prefetch(view.value + Stored::bytes * std::size_t{view.begin[soon]});
      }
    }
    const Float4 force = without_denormals(from.force[from.list[k]] * splat(section.factor));
    if (zero(force)) {
      continue;
    }
    const Float4 f[3] = {splat3(force[0]), splat3(force[1]), splat3(force[2])};
    const std::uint32_t source = from.list[k] - from.begin;
    const auto list = lists[source];
    const std::uint32_t length = lists.length(source);
    for (std::uint32_t n = 0; n < length; ++n) {
      const BlockPlace place = list[n];
      to[place.target] += product(load<mirror, Stored>(view, place.position), f);
    }
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

float widening(const CouplingsView& view) {
  return view.value_bits == 4 ? StoredBlock<4>::widening
                              : (view.value_bits == 8 ? StoredBlock<8>::widening : StoredBlock<16>::widening);
}

// calls visit(column, row, position) for every block, by columns
template <class Visit>
void visit_blocks(const CouplingsView& view, Visit visit) {
  with_columns(view, [&](const auto& columns) {
    for (std::uint32_t j = 0; j < view.columns; ++j) {
      for (std::uint32_t n = 0; n < columns.length(j); ++n) {
        visit(j, columns[j][n].target, columns[j][n].position);
      }
    }
  });
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

void add_direct(const CouplingSection& section, const SparseGroup& columns, Float4* rows) noexcept {
  with_values(section.view, [&](auto stored) {
    with_columns(section.view,
                 [&](const auto& lists) { add_lists<false, decltype(stored)>(section, lists, columns, rows); });
  });
}

void add_mirrored(const CouplingSection& section, const SparseGroup& rows, Float4* columns) noexcept {
  with_values(section.view,
              [&](auto stored) { add_lists<true, decltype(stored)>(section, MirroredRows{section}, rows, columns); });
}

std::uint32_t load_slotted(const CouplingSection& section, std::uint32_t column, const std::uint32_t* slot,
                           BlockPlace* places, Block* blocks) noexcept {
  std::uint32_t count = 0;
  with_columns(section.view,
               [&](const auto& lists) { count = choose(lists[column], lists.length(column), slot, places); });
  with_values(section.view, [&](auto stored) {
    for (std::uint32_t n = 0; n < count; ++n) {
      blocks[n] = load<false, decltype(stored)>(section.view, places[n].position);
    }
  });
  return count;
}

}  // namespace greenloop
