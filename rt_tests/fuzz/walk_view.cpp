#include "rt_tests/fuzz/walk_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "formats/aligned_bytes.hpp"
#include "formats/testing/reseal.hpp"
#include "formats/verify.hpp"

namespace greenloop {
namespace {

class Walk {
 public:
  Walk(std::span<const std::byte> file, const ModelView& view) : file_(file), view_(view) {}

  bool whole_view() {
    if (!array(view_.header, 1) || !array(view_.info, 1) || !array(view_.base_triangles, triangle_corners()) ||
        !array(view_.provenance.data(), view_.provenance.size())) {
      return false;
    }
    if (!all(view_.base_triangles, triangle_corners(), [&](auto corner) { return corner < count(0); })) return false;
    for (std::uint32_t q = 0; q < view_.levels; ++q) {
      if (!level(q)) return false;
    }
    for (std::uint32_t c = 0; c < view_.levels; ++c) {
      for (std::uint32_t r = 0; r < view_.levels; ++r) {
        if (!representatives(c, r) || !blocks(c, r)) return false;
      }
    }
    return true;
  }

 private:
  [[nodiscard]] std::uint32_t count(std::uint32_t q) const { return view_.level[q].counts->node_count; }
  [[nodiscard]] std::uint32_t columns(std::uint32_t c) const { return view_.level[c].counts->column_count; }
  [[nodiscard]] std::size_t triangle_corners() const {
    return std::size_t{3} * view_.level[0].counts->base_triangle_count;
  }

  template <class Record>
  bool array(const Record* records, std::uint64_t count) const {
    if (count == 0) return true;
    const auto begin = reinterpret_cast<std::uintptr_t>(records), file = reinterpret_cast<std::uintptr_t>(file_.data());
    return begin >= file && begin % alignof(Record) == 0 && begin - file <= file_.size() &&
           count <= (file_.size() - (begin - file)) / sizeof(Record);
  }

  template <class Record, class Right>
  static bool all(const Record* records, std::uint64_t count, Right right) {
    return std::all_of(records, records + count, right);
  }

  bool level(std::uint32_t q) const {
    const LevelView& level = view_.level[q];
    if (!array(level.counts, 1) || !array(level.nodes, count(q)) || (q > 0 && !array(level.refinement, count(q))) ||
        !array(level.columns, columns(q))) {
      return false;
    }
    const auto coarser = [&](const layout::RefinementRecord& record) {
      return record.parent[0] < level.node_begin && record.parent[1] < level.node_begin;
    };
    return all(level.nodes, count(q), [](const auto& node) { return std::isfinite(node.position[2] + node.area); }) &&
           (q == 0 || all(level.refinement, count(q), coarser)) &&
           all(level.columns, columns(q),
               [&](const auto& column) { return column.node < level.node_begin + count(q); });
  }

  bool representatives(std::uint32_t c, std::uint32_t q) const {
    const std::uint32_t* column_of = view_.representatives[c][q];
    if (columns(c) == 0) return column_of == nullptr;
    return array(column_of, count(q)) && all(column_of, count(q), [&](std::uint32_t column) {
             return column < columns(c) || column == layout::none;
           });
  }

  bool blocks(std::uint32_t c, std::uint32_t r) const {
    const BlocksView& blocks = view_.blocks[c][r];
    if (columns(c) == 0) return blocks.value == nullptr;
    if (blocks.columns != columns(c) || !array(blocks.begin, blocks.columns + 1ull) ||
        !array(blocks.scale, blocks.columns)) {
      return false;
    }
    if (!all(blocks.scale, blocks.columns, [](float scale) { return std::isfinite(scale) && scale >= 0; }))
      return false;
    const std::uint64_t block_count = blocks.begin[blocks.columns];
    return indices(blocks, block_count) &&
           (blocks.value_bytes == 1 ? values(static_cast<const std::int8_t*>(blocks.value), block_count)
                                    : values(static_cast<const std::int16_t*>(blocks.value), block_count));
  }

  bool indices(const BlocksView& blocks, std::uint64_t block_count) const {
    const auto in_rows = [&](auto row) { return row < blocks.rows; };
    if (blocks.index_bytes == 0) return block_count == std::uint64_t{blocks.columns} * blocks.rows;
    if (blocks.index_bytes == 2) {
      const auto* index = static_cast<const std::uint16_t*>(blocks.index);
      return array(index, block_count) && all(index, block_count, in_rows);
    }
    const auto* index = static_cast<const std::uint32_t*>(blocks.index);
    return array(index, block_count) && all(index, block_count, in_rows);
  }

  // a kernel may load 16 bytes beyond the last value
  template <class Value>
  bool values(const Value* value, std::uint64_t block_count) const {
    const std::uint64_t read = 9 * block_count + 16 / sizeof(Value);
    return array(value, read) && all(value, read, [](Value v) { return static_cast<Value>(-v) == -v; });
  }

  std::span<const std::byte> file_;
  const ModelView& view_;
};

void require(bool right, const char* what) {
  if (right) return;
  std::fprintf(stderr, "verify: %s\n", what);
  std::abort();
}

VerifyResult verify_and_walk(std::span<const std::byte> file) {
  ModelView view;
  const VerifyResult result = verify(file, view);
  require(result.ok() == (view.header != nullptr), "the view does not agree with the verdict");
  require(!result.ok() || walk_view(file, view), "accepted a file whose view is not sound");
  return result;
}

}  // namespace

bool walk_view(std::span<const std::byte> file, const ModelView& view) { return Walk(file, view).whole_view(); }

InputOutcome try_input(std::span<const std::byte> input) {
  verify_and_walk(AlignedBytes(input).span());

  AlignedBytes mended(input.first(input.size() / layout::alignment * layout::alignment));
  if (mended.size() >= sizeof(layout::Header)) {
    reinterpret_cast<layout::Header*>(mended.data())->file_bytes = mended.size();
    reseal({mended.data(), mended.size()});
  }
  const VerifyResult result = verify_and_walk(mended.span());
  return {result.ok(), static_cast<int>(result.rule)};
}

}  // namespace greenloop
