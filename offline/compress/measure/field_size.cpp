#include "offline/compress/measure/field_size.hpp"

#include <algorithm>

#include "offline/compress/encode/touchable_nodes.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/elastostatic/step_work.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop::offline {

FieldCounter::FieldCounter(const ModelView& view) : view_(view), up_to_(std::size_t{view.domain_count} * view.levels) {
  Arena counting;
  carve(counting);
  memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
  Arena arena(memory_.data());
  carve(arena);
  tables_.fill(view);
  refinement_ = tables_.refinement(view, lifting_);
  std::vector<std::uint8_t> read(view.domain_count);
  mark_read(refinement_, touched_, read.data());
  count_field_blocks<3>(view, maker_.make(view, {}, read.data()), {}, up_to_.data());
}

void FieldCounter::carve(Arena& arena) {
  tables_.carve(arena, view_);
  maker_.carve(arena, view_, {});
  touched_.carve(arena, view_);
}

std::uint64_t FieldCounter::blocks_of(std::vector<std::uint32_t> places) {
  std::sort(places.begin(), places.end());
  for (std::uint32_t& place : places) place = make_column(view_.levels - 1, place);
  touch(refinement_, places.data(), static_cast<std::uint32_t>(places.size()), touched_);
  const std::uint64_t blocks = count_field_blocks(FieldBlocks{view_.levels, up_to_.data()}, touched_, view_.levels - 1);
  clear(touched_);
  return blocks;
}

std::uint64_t FieldCounter::all_blocks() const {
  std::uint64_t sum = 0;
  for (std::size_t i = view_.levels - 1; i < up_to_.size(); i += view_.levels) sum += up_to_[i];
  return sum;
}

FieldSize field_size(const ModelView& view) {
  FieldCounter counter(view);
  FieldSize size{.blocks = counter.all_blocks()};
  for (const auto& [node, row] : touchable_nodes(view)) size.longest = std::max(size.longest, counter.blocks_of({row}));
  return size;
}

}  // namespace greenloop::offline
