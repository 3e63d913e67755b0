// What a Couplings section must not say.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::SectionKind;

// The couplings that are broken here: of level 2, where every layer has some.
struct Place {
  std::uint32_t q = 2;
  std::uint32_t layer = 2;
};
constexpr Place words{2, 1}, bytes{2, 2}, nibbles{2, 3};

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 3}));
  return ModelMutant(file);
}

CouplingsHeader& header_of(ModelMutant& mutant, Place place = bytes) {
  return *mutant.records<CouplingsHeader>(SectionKind::couplings, place.q, place.layer);
}

template <class Element>
Element* array(ModelMutant& mutant, std::uint64_t offset, Place place = bytes) {
  return mutant.records<Element>(SectionKind::couplings, place.q, place.layer, offset);
}

std::uint32_t* begin_of(ModelMutant& mutant, Place place = bytes) {
  return array<std::uint32_t>(mutant, header_of(mutant, place).begin_offset, place);
}

template <class Index>
Index* index_of(ModelMutant& mutant, Place place = bytes) {
  REQUIRE(header_of(mutant, place).index_bytes == sizeof(Index));
  return array<Index>(mutant, header_of(mutant, place).index_offset, place);
}

template <class Value>
Value* values_of(ModelMutant& mutant, Place place) {
  return array<Value>(mutant, header_of(mutant, place).value_offset, place);
}

void check_couplings(ModelMutant& mutant, VerifyRule rule, const std::string& field, std::uint64_t index,
                     Place place = bytes) {
  check_refused(mutant, rule, SectionKind::couplings, place.q, place.layer, field, index);
}

template <class Change>
void check_header(VerifyRule rule, const std::string& field, Change change, Place place = bytes) {
  ModelMutant mutant = valid();
  change(header_of(mutant, place));
  check_couplings(mutant, rule, field, 0, place);
}

// The first column of at least `blocks` blocks.
std::uint32_t column_of(ModelMutant& mutant, std::uint32_t blocks) {
  const std::uint32_t* begin = begin_of(mutant);
  const std::uint32_t* end = begin + header_of(mutant).columns;
  const std::uint32_t* column =
      std::adjacent_find(begin, end + 1, [&](std::uint32_t here, std::uint32_t next) { return next - here >= blocks; });
  REQUIRE(column < end);
  return static_cast<std::uint32_t>(column - begin);
}

// The same file, the indices of `bytes` in 4 bytes.
ModelMutant with_wide_index() {
  ModelMutant mutant = valid();
  mutant.rebuild([&](std::vector<SectionCopy>& sections) {
    for (SectionCopy& section : sections) {
      if (!section.is(SectionKind::couplings, bytes.q, bytes.layer)) continue;
      CouplingsHeader header;
      std::memcpy(&header, section.bytes.data(), sizeof(header));
      const auto* narrow = reinterpret_cast<const std::uint16_t*>(section.bytes.data() + header.index_offset);
      const std::vector<std::uint32_t> wide(narrow, narrow + header.block_count);
      const std::size_t room = (wide.size() * 4 + 63) / 64 * 64;
      std::vector<std::byte> widened(section.bytes.begin(), section.bytes.begin() + header.index_offset);
      widened.resize(header.index_offset + room);
      std::memcpy(widened.data() + header.index_offset, wide.data(), wide.size() * 4);
      widened.insert(widened.end(), section.bytes.begin() + header.value_offset, section.bytes.end());
      header.index_bytes = 4;
      header.value_offset = header.index_offset + room;
      std::memcpy(widened.data(), &header, sizeof(header));
      section.bytes = std::move(widened);
    }
  });
  return mutant;
}

template <class Index>
ModelMutant valid_with() {
  return sizeof(Index) == 2 ? valid() : with_wide_index();
}

TEST_CASE("verify refuses: couplings of other columns or rows than their place says, whichever it is") {
  int empty = 0;
  for (std::uint32_t q = 0; q < 3; ++q) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const Place place{q, layer};
      ModelMutant whole = valid();
      const CouplingsHeader right = header_of(whole, place);
      empty += right.block_count == 0 ? 1 : 0;
      for (const std::uint32_t wrong : {0u, 1u, 0xffffffffu, right.rows}) {
        if (wrong != right.columns) {
          check_header(
              VerifyRule::inconsistent, "columns", [&](auto& header) { header.columns = wrong; }, place);
        }
        if (wrong != right.rows) {
          check_header(
              VerifyRule::inconsistent, "rows", [&](auto& header) { header.rows = wrong; }, place);
        }
      }
    }
  }
  CHECK(empty > 0);
  CHECK(empty < 10);
}

TEST_CASE("verify refuses: indices of other sizes than those defined") {
  for (const std::uint32_t size : {0u, 1u, 3u, 8u, 0x10002u}) {
    check_header(VerifyRule::bad_enum, "index_bytes", [&](CouplingsHeader& header) { header.index_bytes = size; });
  }
}

TEST_CASE("verify accepts: 4-byte indices where 2 would do") {
  ModelMutant mutant = with_wide_index();
  CHECK(mutant.verdict().ok());
  const CouplingsView& couplings = mutant.view().level[2].couplings[bytes.layer];
  CHECK(couplings.index_bytes == 4);
  CHECK(couplings.begin[couplings.columns] > 1);
}

TEST_CASE("verify: more than 65536 rows take 4-byte indices, and no others") {
  ModelData data = synthetic_model({.levels = 2, .touchable_above = 1});
  LevelData& level = data.levels[1];
  constexpr std::size_t more = 65536;
  REQUIRE(level.nodes.back().flags == layout::node_fixed);
  layout::NodeRecord node = level.nodes.front();
  node.flags = layout::node_domain;
  level.nodes.insert(level.nodes.begin(), more, node);
  level.refinement.insert(level.refinement.begin(), more, level.refinement.front());
  const layout::Scale<3> scale = level.scales.of<3>().front();
  for (std::size_t i = 0; i < more; ++i) level.scales.push_back(scale);
  for (LevelData& constraint : data.levels) {
    constraint.representatives[1].insert(constraint.representatives[1].begin(), more, layout::none);
  }
  for (CouplingsData& couplings : level.couplings) couplings.begin.insert(couplings.begin.begin(), more, 0);
  CouplingsData& last = level.couplings[2];
  REQUIRE(last.begin.back() > last.begin[last.begin.size() - 2]);
  last.index.back() = more + 11;  // next to the last coefficient, which is its column
  ModelMutant mutant(encode(data));
  CHECK(mutant.verdict().ok());
  const CouplingsView& couplings = mutant.view().level[1].couplings[2];
  CHECK(couplings.rows == more + 13);
  CHECK(couplings.index_bytes == 4);
  header_of(mutant, {1, 2}).index_bytes = 2;
  check_couplings(mutant, VerifyRule::inconsistent, "index_bytes", 0, {1, 2});
}

TEST_CASE("verify refuses: more blocks than there can be, also where the product with a size would wrap") {
  ModelMutant mutant = valid();
  const std::uint64_t columns = header_of(mutant).columns, rows = header_of(mutant).rows;
  REQUIRE(columns < rows);
  const std::uint64_t all = columns * (rows - columns) + columns * (columns - 1) / 2;
  const std::uint64_t wrapping = ~std::uint64_t{0} / 9 + 1;
  for (const std::uint64_t count : {all + 1, std::uint64_t{1} << 33, wrapping, ~std::uint64_t{0}}) {
    for (const Place place : {words, bytes, nibbles}) {
      check_header(
          VerifyRule::out_of_range, "block_count", [&](auto& header) { header.block_count = count; }, place);
    }
  }
  check_header(VerifyRule::out_of_range, "block_count", [](auto& header) { header.block_count = 5 * 4 / 2 + 1; },
               {0, 2});
}

TEST_CASE("verify accepts: a layer that holds every block there can be") {
  ModelMutant mutant(SyntheticOptions{.levels = 2, .epsilon = 0, .quantum = 0.5});
  CHECK(mutant.verdict().ok());
  CHECK(header_of(mutant, {0, nibbles.layer}).block_count == 5 * 4 / 2);
  CHECK(header_of(mutant, {1, nibbles.layer}).block_count == 8 * 5 + 8 * 7 / 2);
}

TEST_CASE("verify refuses: arrays anywhere but where they belong") {
  for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{72}, ~std::uint64_t{63}}) {
    check_header(VerifyRule::inconsistent, "begin_offset", [&](auto& header) { header.begin_offset = offset; });
    check_header(VerifyRule::inconsistent, "index_offset", [&](auto& header) { header.index_offset = offset; });
    check_header(VerifyRule::inconsistent, "value_offset", [&](auto& header) { header.value_offset = offset; });
  }
  check_header(VerifyRule::inconsistent, "index_offset", [](auto& header) { header.index_offset += 64; });
  check_header(VerifyRule::inconsistent, "value_offset", [](auto& header) { header.value_offset += 64; });
}

TEST_CASE("verify refuses: a section that ends before its arrays, or less than 16 bytes after them") {
  for (const Place place : {words, bytes, nibbles}) {
    const std::uint64_t size = valid().entry(SectionKind::couplings, place.q, place.layer).bytes;
    for (const std::uint64_t cut : {std::uint64_t{0}, std::uint64_t{63}, std::uint64_t{64}, size - 1}) {
      ModelMutant mutant = valid();
      mutant.rebuild([&](std::vector<SectionCopy>& sections) {
        for (SectionCopy& section : sections) {
          if (section.is(SectionKind::couplings, place.q, place.layer)) section.bytes.resize(cut);
        }
      });
      check_couplings(mutant, VerifyRule::section_size, "bytes", 0, place);
    }
  }
}

TEST_CASE("verify accepts: 16 or more zero bytes after the values, refuses any other byte there") {
  for (const std::size_t more : {0, 32}) {
    for (const bool zero : {true, false}) {
      ModelMutant mutant = valid();
      std::uint64_t end = 0;
      mutant.rebuild([&](std::vector<SectionCopy>& sections) {
        for (SectionCopy& section : sections) {
          if (!section.is(SectionKind::couplings, bytes.q, bytes.layer)) continue;
          end = section.bytes.size() - 16;
          section.bytes.resize(section.bytes.size() + more);
          if (!zero) section.bytes.back() = std::byte{1};
        }
      });
      if (zero) {
        CHECK(mutant.verdict().ok());
      } else {
        check_couplings(mutant, VerifyRule::padding_not_zero, "padding", end);
      }
    }
  }
}

TEST_CASE("verify refuses: bytes between the arrays that are not zero") {
  const CouplingsHeader header = [] {
    ModelMutant mutant = valid();
    return header_of(mutant);
  }();
  const std::uint64_t ends[] = {header.begin_offset + std::uint64_t{4} * (header.columns + 1),
                                header.index_offset + 2 * header.block_count};
  const std::uint64_t starts[] = {header.index_offset, header.value_offset};
  for (int i = 0; i < 2; ++i) {
    REQUIRE(ends[i] < starts[i]);
    ModelMutant mutant = valid();
    *array<char>(mutant, starts[i] - 1) = 1;
    check_couplings(mutant, VerifyRule::padding_not_zero, "padding", ends[i]);
  }
}

TEST_CASE("verify refuses: reserved bytes of a couplings header in use") {
  check_header(VerifyRule::reserved_not_zero, "reserved", [](CouplingsHeader& header) { header.reserved0 = 1; });
  for (std::size_t k = 0; k < 4; ++k) {
    check_header(VerifyRule::reserved_not_zero, "reserved", [&](CouplingsHeader& header) { header.reserved[k] = 1; });
  }
}

TEST_CASE("verify refuses: columns that do not begin at zero, or begin before the one ahead, or hold too many rows") {
  for (const Place place : {words, bytes, nibbles}) {
    ModelMutant first = valid();
    begin_of(first, place)[0] = 1;
    check_couplings(first, VerifyRule::inconsistent, "begin", 0, place);

    ModelMutant back = valid();
    const std::uint32_t last = header_of(back, place).columns;
    REQUIRE(begin_of(back, place)[last - 1] > 0);
    begin_of(back, place)[last] = begin_of(back, place)[last - 1] - 1;
    check_couplings(back, VerifyRule::not_increasing, "begin", last, place);

    // column 6 follows the coefficients of the coarser levels and six of its own
    ModelMutant full = valid();
    const std::uint32_t before = header_of(full, place).rows - last + 6;
    begin_of(full, place)[7] = begin_of(full, place)[6] + before + 1;
    check_couplings(full, VerifyRule::inconsistent, "begin", 7, place);
  }
}

TEST_CASE("verify refuses: columns that end before or after the last block") {
  for (const int change : {-1, 1}) {
    ModelMutant mutant = valid();
    const std::uint32_t columns = header_of(mutant).columns;
    std::uint32_t* begin = begin_of(mutant);
    // the last columns give up or take a block
    for (std::uint32_t j = columns; j > 0 && begin[j] == header_of(mutant).block_count; --j) begin[j] += change;
    check_couplings(mutant, VerifyRule::inconsistent, "begin", columns);
  }
}

TEST_CASE_TEMPLATE("verify refuses: a coefficient coupled with itself, or with one after it", Index, std::uint16_t,
                   std::uint32_t) {
  ModelMutant whole = valid_with<Index>();
  const std::uint32_t j = column_of(whole, 1), last = begin_of(whole)[j + 1] - 1;
  const std::uint32_t rows = header_of(whole).rows, itself = rows - header_of(whole).columns + j;
  for (const std::uint32_t row : {itself, itself + 1, rows - 1, rows, 0xffffffffu}) {
    ModelMutant mutant = valid_with<Index>();
    index_of<Index>(mutant)[last] = static_cast<Index>(row);
    check_couplings(mutant, VerifyRule::out_of_range, "index", last);
  }
}

TEST_CASE_TEMPLATE("verify refuses: rows that do not increase within a column", Index, std::uint16_t, std::uint32_t) {
  ModelMutant twice = valid_with<Index>();
  const std::uint32_t start = begin_of(twice)[column_of(twice, 2)];
  index_of<Index>(twice)[start + 1] = index_of<Index>(twice)[start];
  check_couplings(twice, VerifyRule::not_increasing, "index", start + 1);

  ModelMutant back = valid_with<Index>();
  std::swap(index_of<Index>(back)[start], index_of<Index>(back)[start + 1]);
  check_couplings(back, VerifyRule::not_increasing, "index", start + 1);
}

TEST_CASE("verify refuses: the most negative value, in 8 and in 16 bits, from the first to the last") {
  for (const Place place : {words, bytes}) {
    ModelMutant whole = valid();
    const std::uint64_t last = 9 * header_of(whole, place).block_count - 1;
    for (const std::uint64_t i : {std::uint64_t{0}, std::uint64_t{20}, last}) {
      ModelMutant mutant = valid();
      if (layout::value_bits[place.layer] == 16) {
        values_of<std::int16_t>(mutant, place)[i] = -32768;
      } else {
        values_of<std::int8_t>(mutant, place)[i] = -128;
      }
      check_couplings(mutant, VerifyRule::out_of_range, "value", i, place);
    }
  }
}

TEST_CASE("verify refuses: the most negative nibble, low or high, and a tenth one that is not zero") {
  ModelMutant whole = valid();
  const std::uint64_t blocks = header_of(whole, nibbles).block_count;
  REQUIRE(blocks > 2);
  for (const std::uint64_t b : {std::uint64_t{0}, std::uint64_t{2}, blocks - 1}) {
    for (std::uint64_t k = 0; k < 10; ++k) {
      ModelMutant mutant = valid();
      auto& byte = values_of<std::uint8_t>(mutant, nibbles)[5 * b + k / 2];
      byte = static_cast<std::uint8_t>(k % 2 == 0 ? (byte & 0xF0) | 8 : (byte & 0x0F) | 0x80);
      const VerifyRule rule = k < 9 ? VerifyRule::out_of_range : VerifyRule::padding_not_zero;
      check_couplings(mutant, rule, "value", 9 * b + std::min<std::uint64_t>(k, 8), nibbles);
    }
  }
}

TEST_CASE("verify accepts: the largest and smallest values of every width") {
  ModelMutant mutant = valid();
  values_of<std::int16_t>(mutant, words)[0] = -32767;
  values_of<std::int16_t>(mutant, words)[1] = 32767;
  values_of<std::int8_t>(mutant, bytes)[0] = -127;
  values_of<std::int8_t>(mutant, bytes)[1] = 127;
  values_of<std::uint8_t>(mutant, nibbles)[0] = 0x97;
  CHECK(mutant.verdict().ok());
}

}  // namespace
}  // namespace greenloop
