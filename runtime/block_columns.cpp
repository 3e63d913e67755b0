#include "runtime/block_columns.hpp"

#include <cstddef>

namespace greenloop {
namespace {

// products this small count as none: keeps denormal numbers out of the field
float without_denormals(float factor) {
  constexpr float least = 0x1p-100F;
  return factor < least && factor > -least ? 0.0F : factor;
}

// rows of a column that keeps every row
struct EveryRow {
  std::uint32_t operator[](std::uint32_t b) const { return b; }
};

// calls visit(row, value of the block) for the blocks of one column in one level of rows
template <class Value, class Rows, class Visit>
void visit_blocks(Rows rows, const Value* value, std::uint32_t count, Visit visit) {
  for (std::uint32_t b = 0; b < count; ++b) {
    visit(rows[b], value);
    value += 9;
  }
}

template <class Value, class Visit>
void visit_rows(const BlocksView& blocks, std::uint32_t column, Visit visit) {
  const std::uint32_t begin = blocks.begin[column];
  const std::uint32_t count = blocks.begin[column + 1] - begin;
  const Value* value = static_cast<const Value*>(blocks.value) + std::size_t{9} * begin;
  if (blocks.index_bytes == 0) {
    visit_blocks(EveryRow{}, value, count, visit);
  } else if (blocks.index_bytes == 2) {
    visit_blocks(static_cast<const std::uint16_t*>(blocks.index) + begin, value, count, visit);
  } else {
    visit_blocks(static_cast<const std::uint32_t*>(blocks.index) + begin, value, count, visit);
  }
}

// calls visit(row, value) with the level's first node and scale set up by prepare(level, scale)
template <class Prepare>
void visit_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column, std::uint32_t row_level,
                  Prepare prepare) {
  for (std::uint32_t level = 0; level <= row_level; ++level) {
    const BlocksView& blocks = view.blocks[constraint_level][level];
    const std::uint32_t node_begin = view.level[level].node_begin;
    const float scale = blocks.scale[column];
    if (blocks.value_bytes == 1) {
      visit_rows<std::int8_t>(blocks, column, prepare(node_begin, scale * widening<std::int8_t>));
    } else {
      visit_rows<std::int16_t>(blocks, column, prepare(node_begin, scale * widening<std::int16_t>));
    }
  }
}

void prefetch_lines(const void* data, std::size_t begin, std::size_t size) {
  constexpr std::size_t line = 64;
  const auto* bytes = static_cast<const char*>(data) + begin;
  for (std::size_t at = 0; at < size; at += line) {
    __builtin_prefetch(bytes + at);
  }
}

}  // namespace

std::uint32_t column_blocks(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                            std::uint32_t row_level) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t level = 0; level <= row_level; ++level) {
    const std::uint32_t* begin = view.blocks[constraint_level][level].begin + column;
    count += begin[1] - begin[0];
  }
  return count;
}

void prefetch_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                     std::uint32_t row_level) noexcept {
  for (std::uint32_t level = 0; level <= row_level; ++level) {
    const BlocksView& blocks = view.blocks[constraint_level][level];
    const std::uint32_t begin = blocks.begin[column];
    const std::uint32_t count = blocks.begin[column + 1] - begin;
    prefetch_lines(blocks.value, std::size_t{9} * blocks.value_bytes * begin,
                   std::size_t{9} * blocks.value_bytes * count);
    prefetch_lines(blocks.index, std::size_t{blocks.index_bytes} * begin, std::size_t{blocks.index_bytes} * count);
    __builtin_prefetch(blocks.scale + column);
  }
}

void add_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column, const float (&force)[3],
                std::uint32_t row_level, Float4* x) noexcept {
  visit_column(view, constraint_level, column, row_level, [&force, x](std::uint32_t node_begin, float scale) {
    const Float4 f0 = splat3(without_denormals(force[0] * scale));
    const Float4 f1 = splat3(without_denormals(force[1] * scale));
    const Float4 f2 = splat3(without_denormals(force[2] * scale));
    return [f0, f1, f2, level = x + node_begin](std::uint32_t row, const auto* value) {
      const Float4 product = (load_widened(value) * f0 + load_widened(value + 3) * f1) + load_widened(value + 6) * f2;
      level[row] += product;
    };
  });
}

void scatter_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column,
                    Block* blocks) noexcept {
  visit_column(view, constraint_level, column, view.levels - 1, [blocks](std::uint32_t node_begin, float scale) {
    return [factor = splat(scale), level = blocks + node_begin](std::uint32_t row, const auto* value) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        level[row].column[c] = load_widened(value + 3 * c) * factor;
      }
    };
  });
}

void clear_column(const ModelView& view, std::uint32_t constraint_level, std::uint32_t column, Block* blocks) noexcept {
  visit_column(view, constraint_level, column, view.levels - 1, [blocks](std::uint32_t node_begin, float) {
    return [level = blocks + node_begin](std::uint32_t row, const auto*) { level[row] = Block{}; };
  });
}

}  // namespace greenloop
