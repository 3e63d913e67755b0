// What a Blocks section must not say.

#include <doctest/doctest.h>

#include <cmath>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::BlocksHeader;
using layout::SectionKind;

constexpr std::uint32_t c = 2, r = 1;  // the section that is broken here

ModelMutant valid() { return ModelMutant(SyntheticOptions{.levels = 3}); }

BlocksHeader& header_of(ModelMutant& mutant) { return *mutant.records<BlocksHeader>(SectionKind::blocks, c, r); }

template <class Element>
Element* array(ModelMutant& mutant, std::uint64_t offset) {
  return mutant.records<Element>(SectionKind::blocks, c, r, offset);
}

void check_blocks(ModelMutant& mutant, VerifyRule rule, const std::string& field, std::uint64_t index) {
  check_refused(mutant, rule, SectionKind::blocks, c, r, field, index);
}

template <class Change>
void check_header(VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(header_of(mutant));
  check_blocks(mutant, rule, field, 0);
}

TEST_CASE("verify refuses: blocks of other columns or rows than the level has") {
  check_header(VerifyRule::inconsistent, "columns", [](BlocksHeader& blocks) { blocks.columns += 1; });
  check_header(VerifyRule::inconsistent, "rows", [](BlocksHeader& blocks) { blocks.rows = 0xffffffff; });
}

TEST_CASE("verify refuses: values and indices of other sizes than those defined") {
  for (const std::uint32_t bytes : {0u, 3u, 4u, 0x80000001u}) {
    check_header(VerifyRule::bad_enum, "value_bytes", [&](BlocksHeader& blocks) { blocks.value_bytes = bytes; });
  }
  for (const std::uint32_t bytes : {1u, 3u, 8u}) {
    check_header(VerifyRule::bad_enum, "index_bytes", [&](BlocksHeader& blocks) { blocks.index_bytes = bytes; });
  }
}

TEST_CASE("verify: more than 65536 rows take 4-byte indices, and no others") {
  ModelData data = synthetic_model({.levels = 1, .touchable_above = 1});
  LevelData& level = data.levels[0];
  REQUIRE(level.nodes.back().flags == layout::node_fixed);
  layout::NodeRecord more = level.nodes.front();
  more.flags = layout::node_domain;
  level.nodes.insert(level.nodes.end() - 1, 65536, more);
  level.representatives[0].resize(level.nodes.size(), layout::none);
  level.blocks[0].index.back() = 65540;
  ModelMutant mutant(encode(data));
  CHECK(mutant.verdict().ok());
  CHECK(mutant.view().blocks[0][0].rows == 65541);
  CHECK(mutant.view().blocks[0][0].index_bytes == 4);
  mutant.records<BlocksHeader>(SectionKind::blocks, 0, 0)->index_bytes = 2;
  check_refused(mutant, VerifyRule::inconsistent, SectionKind::blocks, 0, 0, "index_bytes", 0);
}

TEST_CASE("verify refuses: more blocks than columns times rows, also where the product with a size would wrap") {
  for (const std::uint64_t count : {std::uint64_t{1} << 33, ~std::uint64_t{0} / 9 + 1, ~std::uint64_t{0}}) {
    check_header(VerifyRule::out_of_range, "block_count", [&](BlocksHeader& blocks) { blocks.block_count = count; });
  }
}

TEST_CASE("verify refuses: dense blocks that are fewer than columns times rows") {
  check_header(VerifyRule::inconsistent, "block_count", [](BlocksHeader& blocks) { blocks.index_bytes = 0; });
}

TEST_CASE("verify refuses: arrays anywhere but where they belong") {
  for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{72}, ~std::uint64_t{63}}) {
    check_header(VerifyRule::inconsistent, "begin_offset", [&](BlocksHeader& blocks) { blocks.begin_offset = offset; });
    check_header(VerifyRule::inconsistent, "scale_offset", [&](BlocksHeader& blocks) { blocks.scale_offset = offset; });
    check_header(VerifyRule::inconsistent, "index_offset", [&](BlocksHeader& blocks) { blocks.index_offset = offset; });
    check_header(VerifyRule::inconsistent, "value_offset", [&](BlocksHeader& blocks) { blocks.value_offset = offset; });
  }
  ModelMutant dense(SyntheticOptions{.levels = 3, .dense = true});
  header_of(dense).index_offset = 64;
  check_blocks(dense, VerifyRule::inconsistent, "index_offset", 0);
}

TEST_CASE("verify refuses: a section that ends before its arrays, or less than 16 bytes after them") {
  const std::uint64_t size = valid().entry(SectionKind::blocks, c, r).bytes;
  for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{63}, std::uint64_t{64}, size - 1}) {
    ModelMutant mutant = valid();
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(SectionKind::blocks, c, r)) section.bytes.resize(bytes);
      }
    });
    check_blocks(mutant, VerifyRule::section_size, "bytes", 0);
  }
}

TEST_CASE("verify accepts: more than 16 zero bytes after the values, refuses any other byte there") {
  for (const bool zero : {true, false}) {
    ModelMutant mutant = valid();
    std::uint64_t end = 0;
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (!section.is(SectionKind::blocks, c, r)) continue;
        end = section.bytes.size() - 16;
        section.bytes.resize(section.bytes.size() + 32);
        if (!zero) section.bytes.back() = std::byte{1};
      }
    });
    if (zero) {
      CHECK(mutant.verdict().ok());
    } else {
      check_blocks(mutant, VerifyRule::padding_not_zero, "padding", end);
    }
  }
}

TEST_CASE("verify refuses: bytes between the arrays that are not zero") {
  const BlocksHeader blocks = [] {
    ModelMutant mutant = valid();
    return header_of(mutant);
  }();
  const std::uint64_t ends[] = {blocks.begin_offset + std::uint64_t{4} * (blocks.columns + 1),
                                blocks.scale_offset + std::uint64_t{4} * blocks.columns,
                                blocks.index_offset + 2 * blocks.block_count};
  const std::uint64_t starts[] = {blocks.scale_offset, blocks.index_offset, blocks.value_offset};
  for (int i = 0; i < 3; ++i) {
    REQUIRE(ends[i] < starts[i]);
    ModelMutant mutant = valid();
    *array<char>(mutant, starts[i] - 1) = 1;
    check_blocks(mutant, VerifyRule::padding_not_zero, "padding", ends[i]);
  }
}

TEST_CASE("verify refuses: reserved bytes of a blocks header in use") {
  check_header(VerifyRule::reserved_not_zero, "reserved", [](BlocksHeader& blocks) { blocks.reserved = 1; });
}

TEST_CASE("verify refuses: columns that do not begin at zero, or begin before the one ahead, or hold too many rows") {
  ModelMutant first = valid();
  array<std::uint32_t>(first, header_of(first).begin_offset)[0] = 1;
  check_blocks(first, VerifyRule::inconsistent, "begin", 0);

  ModelMutant back = valid();
  auto* begin = array<std::uint32_t>(back, header_of(back).begin_offset);
  begin[7] = begin[6] - 1;
  check_blocks(back, VerifyRule::not_increasing, "begin", 7);

  ModelMutant full = valid();
  begin = array<std::uint32_t>(full, header_of(full).begin_offset);
  begin[7] = begin[6] + header_of(full).rows + 1;
  check_blocks(full, VerifyRule::inconsistent, "begin", 7);
}

TEST_CASE("verify refuses: columns that end before or after the last block") {
  for (const int change : {-1, 1}) {
    ModelMutant mutant = valid();
    BlocksHeader& blocks = header_of(mutant);
    auto* begin = array<std::uint32_t>(mutant, blocks.begin_offset);
    begin[blocks.columns] += change;
    if (begin[blocks.columns] < begin[blocks.columns - 1]) begin[blocks.columns - 1] = begin[blocks.columns];
    check_blocks(mutant, VerifyRule::inconsistent, "begin", blocks.columns);
  }
}

TEST_CASE("verify refuses: dense columns that do not begin every `rows` blocks") {
  ModelMutant mutant(SyntheticOptions{.levels = 3, .dense = true});
  array<std::uint32_t>(mutant, header_of(mutant).begin_offset)[4] -= 1;
  check_blocks(mutant, VerifyRule::inconsistent, "begin", 4);
}

TEST_CASE("verify refuses: scales that are negative or not finite") {
  for (const float scale : {NAN, INFINITY, -INFINITY}) {
    ModelMutant mutant = valid();
    array<float>(mutant, header_of(mutant).scale_offset)[5] = scale;
    check_blocks(mutant, VerifyRule::not_finite, "scale", 5);
  }
  ModelMutant mutant = valid();
  array<float>(mutant, header_of(mutant).scale_offset)[5] = -1e-30F;
  check_blocks(mutant, VerifyRule::out_of_range, "scale", 5);
}

TEST_CASE("verify refuses: rows outside the domain, or not increasing within a column") {
  ModelMutant mutant = valid();
  const std::uint32_t start = array<std::uint32_t>(mutant, header_of(mutant).begin_offset)[1];
  auto* index = array<std::uint16_t>(mutant, header_of(mutant).index_offset);
  index[start] = static_cast<std::uint16_t>(header_of(mutant).rows);
  check_blocks(mutant, VerifyRule::out_of_range, "index", start);

  ModelMutant twice = valid();
  index = array<std::uint16_t>(twice, header_of(twice).index_offset);
  index[start + 1] = index[start];
  check_blocks(twice, VerifyRule::not_increasing, "index", start + 1);
}

TEST_CASE("verify refuses: the most negative value, in 8 and in 16 bits, up to the very last") {
  ModelMutant small = valid();
  const std::uint64_t last = 9 * header_of(small).block_count - 1;
  array<std::int8_t>(small, header_of(small).value_offset)[last] = -128;
  check_blocks(small, VerifyRule::out_of_range, "value", last);

  ModelMutant large(SyntheticOptions{.levels = 3, .value_bytes = 2});
  array<std::int16_t>(large, header_of(large).value_offset)[20] = -32768;
  check_blocks(large, VerifyRule::out_of_range, "value", 20);
}

}  // namespace
}  // namespace greenloop
