// What the sections of a ready file must not say: anything but what follows from the couplings.

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "formats/ready/base_columns.hpp"
#include "formats/stored_blocks.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/write/ready_file.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;

constexpr std::uint32_t layer_of_8_bits = 2;

std::vector<std::byte> plain(const SyntheticOptions& options, bool one_quantum = false) {
  ModelData data = synthetic_model(options);
  if (one_quantum) data.info.quantum[3] = data.info.quantum[2];
  return encode(data);
}

// everything is read
std::vector<std::byte> made_ready(const std::vector<std::byte>& file) {
  ModelMutant model(file);
  REQUIRE(model.verdict().ok());
  return ready_file(file, std::vector<std::uint8_t>(model.view().domain_count, 1));
}

ModelMutant small() {
  static const std::vector<std::byte> file = made_ready(plain({.levels = 3, .vertices = 5}));
  return ModelMutant(file);
}

// with base columns
ModelMutant large() {
  static const std::vector<std::byte> file = made_ready(plain({.levels = 5, .epsilon = 0}, true));
  return ModelMutant(file);
}

template <class Change>
void check_changed(ModelMutant mutant, VerifyRule rule, SectionKind kind, std::uint32_t a, const std::string& field,
                   std::uint64_t index, Change change) {
  change(mutant);
  check_refused(mutant, rule, kind, a, 0, field, index);
}

TEST_CASE("a ready file shows its tables in place, is of minor 4, and becomes the plain one again") {
  for (const std::uint32_t components : {1U, 3U}) {
    for (const layout::Wavelet wavelet : layout::wavelets) {
      const auto file = plain({.components = components, .levels = 4, .wavelet = wavelet, .vertices = 3});
      ModelMutant ready(made_ready(file)), before(file);
      REQUIRE(ready.verdict().ok());
      REQUIRE(before.verdict().ok());
      CHECK(ready.header().minor == 4);
      CHECK(before.view().ready.read == nullptr);
      CHECK(ready.view().ready.read == ready.records<std::uint8_t>(SectionKind::read_marks));
      for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
        const CouplingsView& mirrored = ready.view().ready.mirrored.layer[layer];
        CHECK(block_count(mirrored) == block_count(before.view(), layer, layer + 1));
      }
      const auto bytes = ready.bytes();
      CHECK(plain_file(bytes) == file);
      CHECK(plain_file(file) == file);
      CHECK(made_ready({bytes.begin(), bytes.end()}) == std::vector<std::byte>(bytes.begin(), bytes.end()));
    }
  }
}

TEST_CASE("a file with a share of the period stays of the minor that brought it, ready and plain again") {
  ModelData data = synthetic_model({.levels = 3});
  data.info.share = 0.25F;
  const auto file = encode(data);
  ModelMutant ready(made_ready(file));
  CHECK(ready.header().minor == 5);
  CHECK(plain_file(ready.bytes()) == file);
}

TEST_CASE("base columns take what they hold out of the mirrored couplings") {
  ModelMutant file = large();
  REQUIRE(file.verdict().ok());
  const ReadyTables& ready = file.view().ready;
  CHECK(ready.base.columns == file.view().level[0].counts->domain_count);
  CHECK(ready.base.holds[3]);
  CHECK(reinterpret_cast<const std::byte*>(ready.base.value) ==
        file.records<std::byte>(SectionKind::base_columns, 0, 0, sizeof(layout::BaseColumnsHeader)));
  CHECK(block_count(ready.mirrored.layer[2]) < block_count(file.view(), 2, 3));
}

TEST_CASE("a cut file has lost what was ready, a whole one keeps it") {
  ModelMutant file = small();
  const std::vector<std::byte> bytes(file.bytes().begin(), file.bytes().end());
  ModelMutant cut(truncate_to_level(bytes, 1)), whole(truncate_to_level(bytes, 2));
  REQUIRE(cut.verdict().ok());
  CHECK(cut.view().ready.read == nullptr);
  REQUIRE(whole.verdict().ok());
  CHECK(whole.view().ready.read != nullptr);
}

TEST_CASE("verify refuses: marks that are none, of another number, or leave a node out that is read") {
  constexpr SectionKind kind = SectionKind::read_marks;
  check_changed(small(), VerifyRule::out_of_range, kind, 0, "read", 4,
                [](ModelMutant& mutant) { mutant.records<std::uint8_t>(kind)[4] = 2; });
  check_changed(small(), VerifyRule::inconsistent, kind, 0, "read", 4,
                [](ModelMutant& mutant) { mutant.records<std::uint8_t>(kind)[4] = 0; });
  check_changed(small(), VerifyRule::section_size, kind, 0, "bytes", 0, [](ModelMutant& mutant) {
    mutant.rebuild([](auto& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(kind)) section.bytes.push_back({});
      }
    });
  });
}

TEST_CASE("verify refuses: base columns other than those that the couplings make") {
  constexpr SectionKind kind = SectionKind::base_columns;
  const auto header = [](ModelMutant& mutant) -> layout::BaseColumnsHeader& {
    return *mutant.records<layout::BaseColumnsHeader>(kind);
  };
  check_changed(small(), VerifyRule::inconsistent, kind, 0, "columns", 0,
                [&](ModelMutant& mutant) { header(mutant).columns = 1; });
  check_changed(large(), VerifyRule::inconsistent, kind, 0, "columns", 0,
                [&](ModelMutant& mutant) { header(mutant).columns = 0; });
  check_changed(large(), VerifyRule::inconsistent, kind, 0, "tiles", 0,
                [&](ModelMutant& mutant) { ++header(mutant).tiles; });
  check_changed(large(), VerifyRule::inconsistent, kind, 0, "layer_mask", 0,
                [&](ModelMutant& mutant) { header(mutant).layer_mask = 4; });
  check_changed(large(), VerifyRule::reserved_not_zero, kind, 0, "reserved", 0,
                [&](ModelMutant& mutant) { header(mutant).reserved[12] = 1; });
  check_changed(large(), VerifyRule::section_size, kind, 0, "bytes", 0, [](ModelMutant& mutant) {
    mutant.rebuild([](auto& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(kind)) section.bytes.pop_back();
      }
    });
  });
  // values of the first tile, of the last one, and beyond the last coefficient
  ModelMutant file = large();
  REQUIRE(file.verdict().ok());
  const std::uint64_t bytes = value_bytes<3>(file.view().ready.base);
  REQUIRE(file.view().domain_count % BaseColumns::width != 0);
  for (const std::uint64_t at : {std::uint64_t{0}, std::uint64_t{9}, bytes - 1, bytes / 2}) {
    CAPTURE(at);
    check_changed(large(), VerifyRule::inconsistent, kind, 0, "value", at, [&](ModelMutant& mutant) {
      mutant.records<std::byte>(kind, 0, 0, sizeof(layout::BaseColumnsHeader) + at)[0] ^= std::byte{1};
    });
  }
}

// a section of mirrored couplings in a file to be broken
struct Mirrored {
  layout::CouplingsHeader& header;
  std::uint32_t* begin;
  std::uint16_t* index;
  std::int8_t* value;

  explicit Mirrored(ModelMutant& mutant, std::uint32_t layer = layer_of_8_bits)
      : header(*mutant.records<layout::CouplingsHeader>(SectionKind::mirrored_couplings, layer)),
        begin(at<std::uint32_t>(mutant, layer, header.begin_offset)),
        index(at<std::uint16_t>(mutant, layer, header.index_offset)),
        value(at<std::int8_t>(mutant, layer, header.value_offset)) {}

 private:
  template <class Element>
  static Element* at(ModelMutant& mutant, std::uint32_t layer, std::uint64_t offset) {
    return mutant.records<Element>(SectionKind::mirrored_couplings, layer, 0, offset);
  }
};

template <class Change>
void check_mirrored(ModelMutant mutant, VerifyRule rule, const std::string& field, std::uint64_t index, Change change) {
  Mirrored mirrored(mutant);
  change(mirrored);
  check_refused(mutant, rule, SectionKind::mirrored_couplings, layer_of_8_bits, 0, field, index);
}

TEST_CASE("verify refuses: mirrored couplings whose form is wrong") {
  check_mirrored(small(), VerifyRule::inconsistent, "rows", 0, [](Mirrored& m) { --m.header.rows; });
  check_mirrored(small(), VerifyRule::inconsistent, "columns", 0, [](Mirrored& m) { ++m.header.columns; });
  check_mirrored(small(), VerifyRule::inconsistent, "begin", 0, [](Mirrored& m) { m.begin[0] = 1; });
  check_mirrored(small(), VerifyRule::not_increasing, "begin", 3, [](Mirrored& m) { m.begin[3] = m.begin[2] - 1; });
  // the first column has blocks, and its rows come after it
  check_mirrored(small(), VerifyRule::out_of_range, "index", 0, [](Mirrored& m) { m.index[0] = 0; });
  check_mirrored(small(), VerifyRule::out_of_range, "index", 1,
                 [](Mirrored& m) { m.index[1] = static_cast<std::uint16_t>(m.header.rows); });
  check_mirrored(small(), VerifyRule::not_increasing, "index", 1, [](Mirrored& m) { m.index[1] = m.index[0]; });
}

TEST_CASE("verify refuses: mirrored couplings other than the stored ones") {
  check_mirrored(small(), VerifyRule::inconsistent, "value", 0, [](Mirrored& m) { m.value[0] ^= 1; });
  check_mirrored(small(), VerifyRule::inconsistent, "value", 9, [](Mirrored& m) { m.value[17] ^= 1; });
  // a block in a row where none of its layer is stored
  ModelMutant file = small();
  Mirrored mirrored(file);
  std::uint32_t column = 0;
  while (mirrored.begin[column] == mirrored.begin[column + 1] ||
         mirrored.index[mirrored.begin[column + 1] - 1] + 1U == mirrored.header.rows) {
    ++column;
  }
  const std::uint32_t last = mirrored.begin[column + 1] - 1;
  check_mirrored(small(), VerifyRule::inconsistent, "index", last, [&](Mirrored& m) { ++m.index[last]; });
}

TEST_CASE("verify refuses: mirrored couplings of which some are left out") {
  ModelMutant mutant = small();
  REQUIRE(mutant.verdict().ok());
  const std::uint32_t count = mutant.view().domain_count;
  mutant.rebuild([&](auto& sections) {
    for (SectionCopy& section : sections) {
      if (!section.is(SectionKind::mirrored_couplings, layer_of_8_bits)) continue;
      const CouplingsData none{.begin = std::vector<std::uint32_t>(count + 1), .index = {}, .value = {}};
      section.bytes = encode_couplings(none, {3, count, count, 8}, "none");
    }
  });
  check_refused(mutant, VerifyRule::inconsistent, SectionKind::mirrored_couplings, layer_of_8_bits, 0, "block_count",
                0);
}

TEST_CASE("verify refuses: a ready file of which a section is missing, twice, or in another place") {
  ModelMutant missing = small();
  missing.rebuild([](auto& sections) { sections.pop_back(); });
  CHECK(missing.verdict().rule == VerifyRule::section_missing);
  ModelMutant twice = small();
  twice.rebuild([](auto& sections) { sections.push_back(SectionCopy(sections.back())); });
  CHECK(twice.verdict().rule == VerifyRule::section_duplicate);
  ModelMutant swapped = small();
  swapped.rebuild([](auto& sections) { std::swap(sections[sections.size() - 2], sections.back()); });
  CHECK(swapped.verdict().rule == VerifyRule::section_order);
  ModelMutant before_the_map = small();
  before_the_map.rebuild([](auto& sections) {
    const auto map = std::find_if(sections.begin(), sections.end(),
                                  [](const SectionCopy& section) { return section.is(SectionKind::vertex_map); });
    std::rotate(map, map + 1, sections.end());
  });
  CHECK(before_the_map.verdict().rule == VerifyRule::section_order);
}

TEST_CASE("verify refuses: ready sections in a file of a minor version that had none") {
  ModelMutant mutant = small();
  mutant.header().minor = 3;
  const std::uint32_t place = mutant.place(SectionKind::read_marks);
  check_refused(mutant, VerifyRule::bad_enum, SectionKind::read_marks, 0, 0, "section.kind", place);
}

TEST_CASE("a file is not made ready with marks of another number, nor if it is no model") {
  const auto file = plain({.levels = 2});
  const std::vector<std::uint8_t> one(1, 1);
  CHECK_THROWS_AS(static_cast<void>(ready_file(file, one)), std::invalid_argument);
  CHECK_THROWS_AS(static_cast<void>(ready_file({}, one)), std::invalid_argument);
  CHECK_THROWS_AS(static_cast<void>(plain_file({})), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop
