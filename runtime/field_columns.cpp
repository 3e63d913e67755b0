#include "runtime/field_columns.hpp"

#include <bit>
#include <cfloat>
#include <cstddef>
#include <cstring>

#include "formats/stored_blocks.hpp"
#include "runtime/couplings.hpp"
#include "runtime/domain.hpp"

namespace greenloop {
namespace {

constexpr std::ptrdiff_t most_prefetched = 2048;  // bytes of a column; the rest follows by itself

// the nearest number of 8 significant bits, of two the even one: the upper half of a float
std::uint16_t upper_half(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<std::uint16_t>((bits + (0x7fff + (bits >> 16 & 1))) >> 16);
}

void add(const Block& block, Block& sum) {
  for (std::uint32_t c = 0; c < 3; ++c) {
    sum.column[c] += block.column[c];
  }
}

void add(float weight, const Block& block, Block& sum) {
  for (std::uint32_t c = 0; c < 3; ++c) {
    sum.column[c] += splat(weight) * block.column[c];
  }
}

// Frobenius
double square_norm(const Block& block) {
  double sum = 0;
  for (const Float4& column : block.column) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      sum += double{column[r]} * double{column[r]};
    }
  }
  return sum;
}

// of level l, whose coefficients each move a fraction of 4^-l of the surface
double spread(std::uint32_t level) {
  double spread = 1;
  for (std::uint32_t l = 0; l < level; ++l) {
    spread *= 0.25;
  }
  return spread;
}

// the upper half of a block; what is left of it stays
ColumnBlock take_half(Block& block, std::uint32_t place) {
  ColumnBlock half = {.byte_offset = place * static_cast<std::uint32_t>(sizeof(Float4)), .value = {}, .zero = 0};
  for (std::uint32_t k = 0; k < 9; ++k) {
    half.value[k] = upper_half(block.column[k / 3][k % 3]);
    block.column[k / 3][k % 3] -= std::bit_cast<float>(std::uint32_t{half.value[k]} << 16);
  }
  return half;
}

bool is_finite(const ColumnBlock& block) {
  for (const std::uint16_t value : block.value) {
    if ((value & 0x7f80) == 0x7f80) {
      return false;
    }
  }
  return true;
}

// M: fourth lanes undefined
Block stored_block(const CouplingsView& view, std::uint32_t bits, std::uint32_t position) {
  const auto at = [&](auto stored) {
    using Stored = decltype(stored);
    return Stored::load(view.value + Stored::bytes * std::size_t{position});
  };
  return bits == 4 ? at(StoredBlock<4>{}) : bits == 8 ? at(StoredBlock<8>{}) : at(StoredBlock<16>{});
}

}  // namespace

void prefetch_column(const FieldColumns& columns, std::uint32_t column) noexcept {
  const std::uint32_t* begin = column_begin(columns, column);
  const auto* at = reinterpret_cast<const std::byte*>(columns.block + begin[0]);
  const auto* end = reinterpret_cast<const std::byte*>(columns.block + begin[columns.levels]);
  end = end - at > most_prefetched ? at + most_prefetched : end;
  for (; at < end; at += 64) {
    __builtin_prefetch(at);
  }
}

void add_column(const FieldColumns& columns, std::uint32_t column, std::uint32_t field_level, Float4 force,
                const SparseCoefficients& sums) noexcept {
  const std::uint32_t* begin = column_begin(columns, column);
  columns.add(columns.block + begin[0], columns.block + begin[field_level + 1], force, sums);
}

void FieldColumnMaker::carve(Arena& arena, const ModelView& view) noexcept {
  view_ = &view;
  columns_.levels = view.levels;
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    begin_[c] = arena.take<std::uint32_t>(std::uint64_t{domain_up_to(view, c)} * view.levels + 1);
    columns_.begin[c] = begin_[c];
  }
  mirrored_begin_ = arena.take<std::uint32_t>(view.domain_count + std::uint64_t{1});
  mirrored_ = arena.take<MirroredBlock>(block_count(view, 0, layout::layers));
  sum_ = arena.take_zeroed<Block>(view.domain_count);
  read_ = arena.take<std::uint8_t>(view.domain_count);
  wanted_ = arena.take<std::uint8_t>(view.domain_count);
}

void FieldColumnMaker::list_mirrored() noexcept {
  const ModelView& view = *view_;
  const auto visit = [&](auto use) {
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
        const CouplingsView& couplings = view.level[q].couplings[layer];
        for (std::uint32_t j = 0; j < couplings.columns; ++j) {
          const std::uint32_t column = view.level[q].domain_begin + j;
          visit_rows(couplings, j, 0, column, [&](std::uint32_t row, std::uint32_t position) {
            use(row, MirroredBlock{column, layer << 30 | position});
          });
        }
      }
    }
  };
  std::memset(mirrored_begin_, 0, sizeof(std::uint32_t) * (view.domain_count + std::size_t{1}));
  visit([&](std::uint32_t row, const MirroredBlock&) { ++mirrored_begin_[row + 1]; });
  for (std::uint32_t i = 0; i < view.domain_count; ++i) {
    mirrored_begin_[i + 1] += mirrored_begin_[i];
  }
  visit([&](std::uint32_t row, const MirroredBlock& block) { mirrored_[mirrored_begin_[row]++] = block; });
  std::memmove(mirrored_begin_ + 1, mirrored_begin_, sizeof(std::uint32_t) * view.domain_count);
  mirrored_begin_[0] = 0;
}

void FieldColumnMaker::mark_read(const Refinement& refinement, Touched& touched) noexcept {
  const ModelView& view = *view_;
  std::memset(read_, 0, view.domain_count);
  for (std::uint32_t place = 0; place < view.domain_count; ++place) {
    const LevelView& level = view.level[refinement.level[place]];
    if ((level.nodes[place - level.domain_begin].flags & layout::node_read) == 0) {
      continue;
    }
    const std::uint32_t column = make_column(view.levels - 1, place);
    touch(refinement, &column, 1, touched);
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
        read_[touched.list[q][k]] = 1;
      }
    }
    clear(touched);
  }
}

void FieldColumnMaker::mark_representatives(std::uint32_t c) noexcept {
  const ModelView& view = *view_;
  std::memset(wanted_, 0, view.domain_count);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t i = 0; i < view.level[q].counts->node_count; ++i) {
      const std::uint32_t node = view.representatives[c][q][i];
      if (node != layout::none) {
        wanted_[domain_place(view, node)] = 1;
      }
    }
  }
}

// sums += the blocks of a coefficient times scaled forces on it
void FieldColumnMaker::add_couplings(std::uint32_t coefficient, std::uint32_t level, const Block& force) noexcept {
  const ModelView& view = *view_;
  Block scaled[layout::layers];
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    scaled[layer] = {};
    add(block_factor(*view.info, layer), force, scaled[layer]);
  }
  const LevelView& own = view.level[level];
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const CouplingsView& couplings = own.couplings[layer];
    visit_rows(couplings, coefficient - own.domain_begin, 0, coefficient,
               [&](std::uint32_t row, std::uint32_t position) {
                 add(product(stored_block(couplings, layout::value_bits[layer], position), scaled[layer]), sum_[row]);
               });
  }
  std::uint32_t q = level;  // of the block's column: they come level by level in each layer
  for (std::uint32_t k = mirrored_begin_[coefficient]; k < mirrored_begin_[coefficient + 1]; ++k) {
    const MirroredBlock block = mirrored_[k];
    while (block.column >= domain_up_to(view, q)) {
      ++q;
    }
    while (block.column < view.level[q].domain_begin) {
      --q;
    }
    const Block stored =
        stored_block(view.level[q].couplings[block.layer()], layout::value_bits[block.layer()], block.position());
    add(product(transposed(stored), scaled[block.layer()]), sum_[block.column]);
  }
}

// the blocks of a column, unscaled, in sum_; returns the square norm of the node's own compliance
double FieldColumnMaker::sum_column(const Refinement& refinement, std::uint32_t column, Touched& touched,
                                    Float4* force) noexcept {
  const ModelView& view = *view_;
  touch(refinement, &column, 1, touched);
  force[column_place(column)] = splat3(1.0F);
  transform_forces(refinement, touched, force);
  const auto scale = [&](std::uint32_t coefficient, std::uint32_t q) -> const layout::Scale& {
    return view.level[q].scales[coefficient - view.level[q].domain_begin];
  };
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t i = touched.list[q][k];
      Block scaled{};
      add(force[i][0], symmetric_block(scale(i, q).root), scaled);
      add(product(symmetric_block(scale(i, q).diagonal), scaled), sum_[i]);
      add_couplings(i, q, scaled);
    }
  }
  for (std::uint32_t i = 0; i < view.domain_count; ++i) {
    sum_[i] = product(symmetric_block(scale(i, refinement.level[i]).root), sum_[i]);
  }
  Block own{};
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t i = touched.list[q][k];
      add(force[i][0], sum_[i], own);
    }
  }
  clear_forces(touched, force);
  clear(touched);
  return square_norm(own);
}

// what a column keeps: square norms
FieldColumnMaker::Limits FieldColumnMaker::limits(const Refinement& refinement, double own) const noexcept {
  const auto square = [](float value) { return double{value} * double{value}; };
  double energy = 0;
  for (std::uint32_t i = 0; i < view_->domain_count; ++i) {
    energy += read_[i] * spread(refinement.level[i]) * square_norm(sum_[i]);
  }
  return {square(view_->info->field_threshold) * energy, square(view_->info->field_peak_threshold) * own};
}

// moves what is kept of level q from sum_ to the end of the blocks
void FieldColumnMaker::keep_level(std::uint32_t q, const Limits& limits, const Room& room, Counts& counts) noexcept {
  const LevelView& level = view_->level[q];
  const double least = limits.spread_norm / spread(q);
  for (std::uint32_t i = level.domain_begin; i < domain_up_to(*view_, q); ++i) {
    const double norm = square_norm(sum_[i]);
    counts.finite = counts.finite && norm <= DBL_MAX;
    if (norm > 0 && read_[i] != 0 && (norm >= least || norm >= limits.norm)) {
      for (std::uint32_t half = 0; half < view_->info->field_halves; ++half) {
        const ColumnBlock block = take_half(sum_[i], i);
        counts.finite = counts.finite && is_finite(block);
        if (room.block != nullptr && counts.blocks < room.blocks) {
          room.block[counts.blocks] = block;
        }
        ++counts.blocks;
      }
    }
    sum_[i] = {};
  }
}

FieldColumnMaker::Counts FieldColumnMaker::make(const Refinement& refinement, Touched& touched, Float4* force,
                                                const Room& room) noexcept {
  const ModelView& view = *view_;
  Counts counts;
  columns_.block = room.block;
  list_mirrored();
  mark_read(refinement, touched);
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    mark_representatives(c);
    std::uint32_t* begin = begin_[c];
    for (std::uint32_t place = 0; place < domain_up_to(view, c) && counts.within(room); ++place) {
      const std::uint64_t first = counts.blocks;
      Limits kept;
      if (wanted_[place] != 0) {
        kept = limits(refinement, sum_column(refinement, make_column(c, place), touched, force));
      }
      for (std::uint32_t q = 0; q < view.levels; ++q) {
        *begin++ = static_cast<std::uint32_t>(counts.blocks);
        if (wanted_[place] != 0) {
          keep_level(q, kept, room, counts);
        }
      }
      const auto length = static_cast<std::uint32_t>(counts.blocks - first);
      counts.longest = length > counts.longest ? length : counts.longest;
    }
    *begin = static_cast<std::uint32_t>(counts.blocks);
  }
  return counts;
}

}  // namespace greenloop
