// What a Couplings section must not say.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::Partner;
using layout::SectionKind;
using layout::Strength;

constexpr std::uint16_t same = layout::coupling_index(Partner::same, Strength::strong);

// The couplings that are broken here: of the details of level 2 with those of level 1, or with each other.
struct Place {
  std::uint32_t q = 2;
  std::uint16_t b = layout::coupling_index(Partner::parents, Strength::strong);
};
constexpr Place rectangular{}, triangular{2, same}, base{0, same};
constexpr Place nibbles{2, layout::coupling_index(Partner::parents, Strength::weak)};

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 3}));
  return ModelMutant(file);
}

CouplingsHeader& header_of(ModelMutant& mutant, Place place = rectangular) {
  return *mutant.records<CouplingsHeader>(SectionKind::couplings, place.q, place.b);
}

template <class Element>
Element* array(ModelMutant& mutant, std::uint64_t offset, Place place = rectangular) {
  return mutant.records<Element>(SectionKind::couplings, place.q, place.b, offset);
}

std::uint32_t* begin_of(ModelMutant& mutant, Place place = rectangular) {
  return array<std::uint32_t>(mutant, header_of(mutant, place).begin_offset, place);
}

std::uint16_t* index_of(ModelMutant& mutant, Place place = rectangular) {
  return array<std::uint16_t>(mutant, header_of(mutant, place).index_offset, place);
}

void check_couplings(ModelMutant& mutant, VerifyRule rule, const std::string& field, std::uint64_t index,
                     Place place = rectangular) {
  check_refused(mutant, rule, SectionKind::couplings, place.q, place.b, field, index);
}

template <class Change>
void check_header(VerifyRule rule, const std::string& field, Change change, Place place = rectangular) {
  ModelMutant mutant = valid();
  change(header_of(mutant, place));
  check_couplings(mutant, rule, field, 0, place);
}

TEST_CASE("verify refuses: couplings of other columns or rows than their place says, whichever it is") {
  for (std::uint32_t q = 0; q < 3; ++q) {
    for (std::uint16_t b = 0; b < 3 * layout::strengths; ++b) {
      if (q == 0 ? b != same : q == 1 && b / layout::strengths == 1) continue;
      check_header(VerifyRule::inconsistent, "columns", [](CouplingsHeader& header) { header.columns += 1; }, {q, b});
      check_header(VerifyRule::inconsistent, "rows", [](CouplingsHeader& header) { header.rows = 0xffffffff; }, {q, b});
    }
  }
}

TEST_CASE("verify refuses: values and indices of other sizes than those defined") {
  for (const std::uint32_t bits : {0u, 1u, 5u, 32u, 0x80000008u}) {
    check_header(VerifyRule::bad_enum, "value_bits", [&](CouplingsHeader& header) { header.value_bits = bits; });
  }
  for (const std::uint32_t bytes : {1u, 3u, 8u}) {
    check_header(VerifyRule::bad_enum, "index_bytes", [&](CouplingsHeader& header) { header.index_bytes = bytes; });
  }
}

TEST_CASE("verify refuses: level 0 in other than 16 bits or with indices, finer levels without") {
  for (const std::uint32_t bits : {4u, 8u}) {
    check_header(
        VerifyRule::inconsistent, "value_bits", [&](auto& header) { header.value_bits = bits; }, base);
  }
  for (const std::uint32_t bytes : {2u, 4u}) {
    check_header(
        VerifyRule::inconsistent, "index_bytes", [&](auto& header) { header.index_bytes = bytes; }, base);
  }
  check_header(VerifyRule::inconsistent, "index_bytes", [](CouplingsHeader& header) { header.index_bytes = 0; });
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
  level.details.insert(level.details.begin(), more, level.details.front());
  for (LevelData& constraint : data.levels) {
    constraint.representatives[1].insert(constraint.representatives[1].begin(), more, layout::none);
  }
  for (auto& partner : level.couplings) {
    for (CouplingsData& couplings : partner) {
      if (!couplings.begin.empty()) couplings.begin.insert(couplings.begin.begin(), more, 0);
    }
  }
  CouplingsData& last = level.couplings[static_cast<std::size_t>(Partner::same)][0];
  REQUIRE_FALSE(last.index.empty());
  last.index.back() = more + 6;
  ModelMutant mutant(encode(data));
  CHECK(mutant.verdict().ok());
  const CouplingsView& couplings = mutant.view().level[1].couplings[2][0];
  CHECK(couplings.rows == more + 8);
  CHECK(couplings.index_bytes == 4);
  header_of(mutant, {1, same}).index_bytes = 2;
  check_couplings(mutant, VerifyRule::inconsistent, "index_bytes", 0, {1, same});
}

TEST_CASE("verify refuses: more blocks than there can be, also where the product with a size would wrap") {
  ModelMutant mutant = valid();
  const std::uint64_t columns = header_of(mutant).columns, rows = header_of(mutant).rows;
  const std::uint64_t wrapping = ~std::uint64_t{0} / 9 + 1;
  for (const std::uint64_t count : {columns * rows + 1, std::uint64_t{1} << 33, wrapping, ~std::uint64_t{0}}) {
    check_header(VerifyRule::out_of_range, "block_count", [&](auto& header) { header.block_count = count; });
  }
  for (const std::uint64_t count : {columns * (columns - 1) / 2 + 1, wrapping}) {
    check_header(
        VerifyRule::out_of_range, "block_count", [&](auto& header) { header.block_count = count; }, triangular);
  }
}

TEST_CASE("verify refuses: a level 0 that does not hold every block") {
  check_header(
      VerifyRule::inconsistent, "block_count", [](CouplingsHeader& header) { header.block_count -= 1; }, base);
}

TEST_CASE("verify refuses: a quantum that is negative, above one or not finite") {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    check_header(VerifyRule::not_finite, "quantum", [&](CouplingsHeader& header) { header.quantum = bad; });
  }
  for (const float bad : {-1e-30F, 1.0000001F}) {
    check_header(VerifyRule::out_of_range, "quantum", [&](CouplingsHeader& header) { header.quantum = bad; });
  }
  for (const float right : {0.0F, 1.0F}) {
    ModelMutant mutant = valid();
    header_of(mutant).quantum = right;
    CHECK(mutant.verdict().ok());
  }
}

TEST_CASE("verify refuses: arrays anywhere but where they belong") {
  for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{72}, ~std::uint64_t{63}}) {
    check_header(VerifyRule::inconsistent, "begin_offset", [&](auto& header) { header.begin_offset = offset; });
    check_header(VerifyRule::inconsistent, "index_offset", [&](auto& header) { header.index_offset = offset; });
    check_header(VerifyRule::inconsistent, "value_offset", [&](auto& header) { header.value_offset = offset; });
  }
  check_header(
      VerifyRule::inconsistent, "index_offset", [](auto& header) { header.index_offset = 64; }, base);
}

TEST_CASE("verify refuses: a section that ends before its arrays, or less than 16 bytes after them") {
  for (const Place place : {rectangular, nibbles, base}) {
    const std::uint64_t size = valid().entry(SectionKind::couplings, place.q, place.b).bytes;
    for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{63}, std::uint64_t{64}, size - 1}) {
      ModelMutant mutant = valid();
      mutant.rebuild([&](std::vector<SectionCopy>& sections) {
        for (SectionCopy& section : sections) {
          if (section.is(SectionKind::couplings, place.q, place.b)) section.bytes.resize(bytes);
        }
      });
      check_couplings(mutant, VerifyRule::section_size, "bytes", 0, place);
    }
  }
}

TEST_CASE("verify accepts: more than 16 zero bytes after the values, refuses any other byte there") {
  for (const bool zero : {true, false}) {
    ModelMutant mutant = valid();
    std::uint64_t end = 0;
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (!section.is(SectionKind::couplings, rectangular.q, rectangular.b)) continue;
        end = section.bytes.size() - 16;
        section.bytes.resize(section.bytes.size() + 32);
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
  check_header(VerifyRule::reserved_not_zero, "reserved", [](CouplingsHeader& header) { header.reserved[2] = 1; });
}

TEST_CASE("verify refuses: columns that do not begin at zero, or begin before the one ahead, or hold too many rows") {
  ModelMutant first = valid();
  begin_of(first)[0] = 1;
  check_couplings(first, VerifyRule::inconsistent, "begin", 0);

  ModelMutant back = valid();
  REQUIRE(begin_of(back)[6] > 0);
  begin_of(back)[7] = begin_of(back)[6] - 1;
  check_couplings(back, VerifyRule::not_increasing, "begin", 7);

  ModelMutant full = valid();
  begin_of(full)[7] = begin_of(full)[6] + header_of(full).rows + 1;
  check_couplings(full, VerifyRule::inconsistent, "begin", 7);

  ModelMutant triangle = valid();
  begin_of(triangle, triangular)[7] = begin_of(triangle, triangular)[6] + 7;
  check_couplings(triangle, VerifyRule::inconsistent, "begin", 7, triangular);
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

TEST_CASE("verify refuses: columns of level 0 that do not hold every row before them") {
  ModelMutant mutant = valid();
  begin_of(mutant, base)[3] -= 1;
  check_couplings(mutant, VerifyRule::inconsistent, "begin", 3, base);
}

TEST_CASE("verify refuses: rows out of range, or not increasing within a column") {
  ModelMutant mutant = valid();
  const std::uint32_t* begin = begin_of(mutant);
  const auto column = std::adjacent_find(begin, begin + header_of(mutant).columns,
                                         [](std::uint32_t here, std::uint32_t next) { return next - here >= 2; });
  const std::uint32_t start = *column;
  index_of(mutant)[start] = static_cast<std::uint16_t>(header_of(mutant).rows);
  check_couplings(mutant, VerifyRule::out_of_range, "index", start);

  ModelMutant twice = valid();
  index_of(twice)[start + 1] = index_of(twice)[start];
  check_couplings(twice, VerifyRule::not_increasing, "index", start + 1);
}

TEST_CASE("verify refuses: a coefficient coupled with itself, or with one after it") {
  ModelMutant mutant = valid();
  const std::uint32_t* begin = begin_of(mutant, triangular);
  std::uint32_t j = 0;
  while (begin[j + 1] == 0) ++j;
  const std::uint32_t last = begin[j + 1] - 1;
  for (const std::uint32_t row : {j, j + 1}) {
    ModelMutant self = valid();
    index_of(self, triangular)[last] = static_cast<std::uint16_t>(row);
    check_couplings(self, VerifyRule::out_of_range, "index", last, triangular);
  }
}

TEST_CASE("verify refuses: the most negative value, in 8 and in 16 bits, up to the very last") {
  ModelMutant small = valid();
  const std::uint64_t last = 9 * header_of(small).block_count - 1;
  array<std::int8_t>(small, header_of(small).value_offset)[last] = -128;
  check_couplings(small, VerifyRule::out_of_range, "value", last);

  ModelMutant large = valid();
  array<std::int16_t>(large, header_of(large, base).value_offset, base)[20] = -32768;
  check_couplings(large, VerifyRule::out_of_range, "value", 20, base);
}

TEST_CASE("verify refuses: the most negative nibble, low or high, and a tenth one that is not zero") {
  const std::uint64_t blocks = [] {
    ModelMutant mutant = valid();
    REQUIRE(header_of(mutant, nibbles).value_bits == 4);
    return header_of(mutant, nibbles).block_count;
  }();
  REQUIRE(blocks > 2);
  for (const std::uint64_t b : {std::uint64_t{0}, std::uint64_t{2}, blocks - 1}) {
    for (std::uint64_t k = 0; k < 10; ++k) {
      ModelMutant mutant = valid();
      auto& byte = array<std::uint8_t>(mutant, header_of(mutant, nibbles).value_offset, nibbles)[5 * b + k / 2];
      byte = static_cast<std::uint8_t>(k % 2 == 0 ? (byte & 0xF0) | 8 : (byte & 0x0F) | 0x80);
      const VerifyRule rule = k < 9 ? VerifyRule::out_of_range : VerifyRule::padding_not_zero;
      check_couplings(mutant, rule, "value", 9 * b + std::min<std::uint64_t>(k, 8), nibbles);
    }
  }
}

TEST_CASE("verify accepts: the largest and smallest values of every width") {
  ModelMutant mutant = valid();
  array<std::int16_t>(mutant, header_of(mutant, base).value_offset, base)[0] = -32767;
  array<std::int8_t>(mutant, header_of(mutant).value_offset)[0] = -127;
  array<std::uint8_t>(mutant, header_of(mutant, nibbles).value_offset, nibbles)[0] = 0x97;
  CHECK(mutant.verdict().ok());
}

}  // namespace
}  // namespace greenloop
