// The header, the section table, and files that must be accepted. One test per rule; the sections have theirs beside
// their verifiers.

#include "formats/verify.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/testing/smallest_model.hpp"

namespace greenloop {
namespace {

using layout::SectionEntry;
using layout::SectionKind;

constexpr SectionKind header = {};
constexpr std::uint32_t unknown_kind = 77;

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 2}));
  return ModelMutant(file);
}

void check_accepted(ModelMutant& mutant) {
  const VerifyResult result = mutant.verdict();
  CAPTURE(describe(result));
  CHECK(result.ok());
  CHECK(mutant.view().header == &mutant.header());
}

SectionCopy unknown_section() {
  SectionCopy copy;
  copy.entry.kind = unknown_kind;
  copy.bytes.assign(100, std::byte{0xAB});
  return copy;
}

TEST_CASE("verify accepts: every size of the synthetic model") {
  for (std::uint32_t levels = 1; levels <= 4; ++levels) {
    ModelMutant mutant(SyntheticOptions{.levels = levels});
    check_accepted(mutant);
    CHECK(mutant.view().levels == levels);
    CHECK(mutant.view().node_count == std::vector{6u, 18u, 66u, 258u}[levels - 1]);
  }
}

TEST_CASE("verify accepts: one triangle with one free node") {
  ModelData data = smallest_model();
  LevelData& level = data.levels[0];
  level.nodes[1].flags = layout::node_fixed;
  level.scales.numbers.resize(level.scales.numbers.size() - 12);
  for (CouplingsData& couplings : level.couplings) couplings = {.begin = {0, 0}, .index = {}, .value = {}};
  ModelMutant mutant(encode(data));
  check_accepted(mutant);
  CHECK(mutant.view().domain_count == 1);
  CHECK(mutant.view().level[0].couplings[0].begin[1] == 0);
}

TEST_CASE("verify accepts: levels without domain nodes") {
  ModelData data = smallest_model();
  LevelData none_moves;
  none_moves.nodes = {{{0.5F, 0, 0}, 0.125F, layout::node_fixed}};
  none_moves.refinement = {{{0, 1}, {0, 0}}};
  none_moves.representatives = {{0, layout::none, layout::none}, {layout::none}};
  for (CouplingsData& couplings : none_moves.couplings) couplings.begin = {0};
  data.levels[0].representatives.push_back({layout::none});
  data.levels.push_back(none_moves);
  ModelMutant mutant(encode(data));
  check_accepted(mutant);
  CHECK(mutant.view().domain_count == 2);
}

TEST_CASE("verify: the view shows every array where it stands") {
  ModelMutant mutant(SyntheticOptions{.levels = 4, .coarsest_constraint_level = 1});
  check_accepted(mutant);
  const ModelView& view = mutant.view();
  std::uint32_t nodes = 0, domain = 0;
  for (std::uint32_t q = 0; q < 4; ++q) {
    const LevelView& level = view.level[q];
    CHECK(level.counts == mutant.records<layout::Level>(SectionKind::level, q));
    CHECK(level.nodes == mutant.records<layout::NodeRecord>(SectionKind::nodes, q));
    CHECK(level.node_begin == nodes);
    CHECK(level.domain_begin == domain);
    nodes += level.counts->node_count;
    domain += level.counts->domain_count;
    CHECK(level.scales == mutant.records<layout::Scale<3>>(SectionKind::scales, q));
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      CAPTURE(section_name(SectionKind::couplings, q, layer));
      const CouplingsView& couplings = level.couplings[layer];
      const auto* stored = mutant.records<layout::CouplingsHeader>(SectionKind::couplings, q, layer);
      const auto* start = reinterpret_cast<const std::byte*>(stored);
      CHECK(couplings.columns == (stored->block_count > 0 ? level.counts->domain_count : 0));
      CHECK(couplings.rows == domain);
      CHECK(couplings.index_bytes == 2);
      CHECK(reinterpret_cast<const std::byte*>(couplings.begin) == start + stored->begin_offset);
      CHECK(couplings.index == start + stored->index_offset);
      CHECK(couplings.value == start + stored->value_offset);
    }
    for (std::uint32_t c = 0; c < 4; ++c) {
      CHECK(view.representatives[c][q] ==
            (c == 0 ? nullptr : mutant.records<std::uint32_t>(SectionKind::representatives, c, q)));
    }
  }
  CHECK(view.node_count == nodes);
  CHECK(view.domain_count == domain);
  CHECK(view.problem == layout::Problem::elastostatic);
  CHECK(section_entries(view).data() == mutant.table().data());
  CHECK(section_entries(view).size() == mutant.table().size());
}

TEST_CASE("verify refuses: an unknown problem, whatever its Info looks like otherwise") {
  for (const std::uint32_t problem : {0u, layout::problems_of(layout::version_minor) + 1, 0xffffffffu}) {
    for (const std::size_t bytes : {sizeof(layout::InfoStart), sizeof(layout::Info), sizeof(layout::Info) + 64}) {
      ModelMutant mutant = valid();
      mutant.rebuild([&](std::vector<SectionCopy>& sections) {
        sections[0].bytes.assign(bytes, std::byte{0});
        std::memcpy(sections[0].bytes.data(), &problem, sizeof(problem));
      });
      check_refused(mutant, VerifyRule::bad_enum, SectionKind::info, 0, 0, "problem", 0);
      CHECK(mutant.view().problem == layout::Problem{});
    }
  }
}

TEST_CASE("verify refuses: an Info too short to say its problem") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) { sections[0].bytes.resize(sizeof(layout::InfoStart) - 1); });
  check_refused(mutant, VerifyRule::section_size, SectionKind::info, 0, 0, "bytes", 0);
}

TEST_CASE("verify accepts: every wavelet") {
  for (const layout::Wavelet kind : layout::wavelets) {
    ModelMutant mutant(SyntheticOptions{.levels = 3, .wavelet = kind});
    check_accepted(mutant);
  }
}

TEST_CASE("verify accepts: couplings that all stand in one layer, or in none") {
  const struct {
    std::uint32_t layer;
    SyntheticOptions options;
  } cases[] = {{3, {.levels = 3, .quantum = 0.5}}, {layout::layers, {.levels = 3, .epsilon = 1e9}}};
  for (const auto& [full, options] : cases) {
    ModelMutant mutant(options);
    check_accepted(mutant);
    const auto& couplings = mutant.view().level[2].couplings;
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      CHECK((couplings[layer].begin[couplings[layer].columns] > 0) == (layer == full));
    }
  }
}

TEST_CASE("verify accepts: constraints only on the finest level") {
  ModelMutant mutant(SyntheticOptions{.levels = 3, .coarsest_constraint_level = 2});
  check_accepted(mutant);
  CHECK(mutant.view().representatives[1][0] == nullptr);
  CHECK(mutant.view().representatives[2][0] != nullptr);
}

TEST_CASE("verify accepts: no provenance, and provenance in any language") {
  for (const char* text : {"", "{\"author\": \"Zo\u00eb \u5f20 \U0001F43B\"}"}) {
    ModelData data = synthetic_model({.levels = 1});
    data.provenance = text;
    ModelMutant mutant(encode(data));
    check_accepted(mutant);
    CHECK(std::string(mutant.view().provenance.begin(), mutant.view().provenance.end()) == text);
  }
}

TEST_CASE("verify accepts: a newer minor version with unknown sections anywhere and reserved bytes in use") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    sections.insert(sections.begin(), unknown_section());
    sections.insert(sections.begin() + 7, unknown_section());
    sections.push_back(unknown_section());
  });
  mutant.header().minor = layout::version_minor + 1;
  mutant.header().reserved[0] = 1;
  mutant.records<layout::Info>(SectionKind::info)->reserved[3] = 1;
  mutant.entry(SectionKind::info).reserved = 1;
  check_accepted(mutant);
  CHECK(mutant.view().levels == 2);
}

TEST_CASE("verify accepts: a file cut after any level, seen as the coarser model") {
  const auto whole = encode(synthetic_model({.levels = 4}));
  for (std::uint32_t q = 0; q < 4; ++q) {
    ModelMutant mutant(truncate_to_level(whole, q));
    check_accepted(mutant);
    CHECK(mutant.view().levels == q + 1);
    CHECK(mutant.view().info->levels == 4);
  }
}

TEST_CASE("verify refuses: memory that is not 64-byte aligned") {
  const auto file = encode(synthetic_model({.levels = 1}));
  AlignedBytes memory(file.size() + 64);
  std::memcpy(memory.data() + 16, file.data(), file.size());
  ModelView view;
  check_refusal(verify(memory.span().subspan(16, file.size()), view), VerifyRule::misaligned_memory, header, 0, 0,
                "address", 0);
}

TEST_CASE("verify refuses: fewer bytes than a header, down to none") {
  ModelView view;
  check_refusal(verify({}, view), VerifyRule::too_short, header, 0, 0, "bytes", 0);
  const AlignedBytes memory(63);
  check_refusal(verify(memory.span(), view), VerifyRule::too_short, header, 0, 0, "bytes", 0);
}

TEST_CASE("verify refuses: any other magic") {
  ModelMutant mutant = valid();
  mutant.header().magic[7] = '\r';
  check_refused(mutant, VerifyRule::bad_magic, header, 0, 0, "magic", 7);
}

TEST_CASE("verify refuses: big-endian files") {
  ModelMutant mutant = valid();
  mutant.header().endian = 0x04030201;
  check_refused(mutant, VerifyRule::foreign_endianness, header, 0, 0, "endian", 0);
}

TEST_CASE("verify refuses: another major version, older or newer") {
  for (const int major : {layout::version_major - 1, layout::version_major + 1}) {
    ModelMutant mutant = valid();
    mutant.header().major = static_cast<std::uint16_t>(major);
    check_refused(mutant, VerifyRule::unsupported_major, header, 0, 0, "major", 0);
  }
}

TEST_CASE("verify refuses: a length that is not the file's, or not a multiple of 64") {
  ModelMutant mutant = valid();
  mutant.header().file_bytes += 64;
  check_refused(mutant, VerifyRule::wrong_length, header, 0, 0, "file_bytes", 0);
  ModelMutant odd = valid();
  odd.resize(odd.bytes().size() + 4);
  check_refused(odd, VerifyRule::wrong_length, header, 0, 0, "file_bytes", 0);
}

TEST_CASE("verify refuses: a whole empty block after the last section") {
  ModelMutant mutant = valid();
  mutant.resize(mutant.bytes().size() + 64);
  check_refused(mutant, VerifyRule::wrong_length, header, 0, 0, "file_bytes", 0);
}

TEST_CASE("verify refuses: a file cut short at any multiple of 64") {
  ModelMutant whole = valid();
  for (std::size_t size = 64; size < whole.bytes().size(); size += 64) {
    ModelMutant mutant(whole.bytes());
    mutant.resize(size);
    CHECK_FALSE(mutant.verdict().ok());
  }
}

TEST_CASE("verify refuses: a damaged header") {
  ModelMutant mutant = valid();
  reseal(mutant.bytes());
  mutant.header().levels ^= 1;
  ModelView view;
  check_refusal(verify(mutant.bytes(), view), VerifyRule::header_checksum, header, 0, 0, "header_crc", 0);
}

TEST_CASE("verify refuses: a damaged table") {
  ModelMutant mutant = valid();
  mutant.table()[3].a ^= 1;
  ModelView view;
  check_refusal(verify(mutant.bytes(), view), VerifyRule::table_checksum, header, 0, 0, "table_crc", 0);
}

TEST_CASE("verify refuses: a damaged section") {
  ModelMutant mutant = valid();
  *mutant.records<char>(SectionKind::nodes, 1, 0, 11) ^= 1;
  ModelView view;
  check_refusal(verify(mutant.bytes(), view), VerifyRule::section_checksum, SectionKind::nodes, 1, 0, "section.crc",
                mutant.place(SectionKind::nodes, 1));
}

TEST_CASE("verify refuses: more levels than there can be, or none") {
  for (const std::uint32_t levels : {0u, layout::max_levels + 1, 0xffffffffu}) {
    ModelMutant mutant = valid();
    mutant.header().levels = levels;
    check_refused(mutant, VerifyRule::out_of_range, header, 0, 0, "levels", 0);
  }
}

TEST_CASE("verify refuses: more sections than fit in the file") {
  for (const std::uint32_t count : {100'000u, 0xffffffffu}) {
    ModelMutant mutant = valid();
    mutant.header().section_count = count;
    check_refused(mutant, VerifyRule::section_out_of_bounds, header, 0, 0, "section_count", 0);
  }
}

TEST_CASE("verify refuses: a section that starts or ends past the end, also where the sum wraps around") {
  for (const std::uint64_t offset : {std::uint64_t{1} << 40, ~std::uint64_t{63}}) {
    ModelMutant mutant = valid();
    const std::uint32_t place = mutant.place(SectionKind::scales, 1);
    mutant.table()[place].offset = offset;
    check_refused(mutant, VerifyRule::section_out_of_bounds, SectionKind::scales, 1, 0, "section.offset", place);
  }
  for (const std::uint64_t bytes : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    ModelMutant mutant = valid();
    const std::uint32_t place = mutant.place(SectionKind::scales, 1);
    mutant.table()[place].bytes = bytes;
    check_refused(mutant, VerifyRule::section_out_of_bounds, SectionKind::scales, 1, 0, "section.bytes", place);
  }
}

TEST_CASE("verify refuses: a section that does not start at a multiple of 64") {
  ModelMutant mutant = valid();
  const std::uint32_t place = mutant.place(SectionKind::nodes, 0);
  mutant.table()[place].offset += 4;
  check_refused(mutant, VerifyRule::section_misaligned, SectionKind::nodes, 0, 0, "section.offset", place);
}

TEST_CASE("verify refuses: a section that starts before the one ahead of it ends, or inside the table") {
  ModelMutant mutant = valid();
  const std::uint32_t place = mutant.place(SectionKind::nodes, 1);
  mutant.table()[place].offset -= 64;
  check_refused(mutant, VerifyRule::section_overlap, SectionKind::nodes, 1, 0, "section.offset", place);
  ModelMutant first = valid();
  first.table()[0].offset = 64;
  check_refused(first, VerifyRule::section_overlap, SectionKind::info, 0, 0, "section.offset", 0);
}

TEST_CASE("verify refuses: sections in another order") {
  ModelMutant mutant = valid();
  const std::uint32_t place = mutant.place(SectionKind::nodes, 0);
  mutant.rebuild([&](std::vector<SectionCopy>& sections) { std::swap(sections[place], sections[place + 1]); });
  check_refused(mutant, VerifyRule::section_order, SectionKind::base_triangles, 0, 0, "section", place);
}

TEST_CASE("verify refuses: a level beyond those the header states") {
  ModelMutant mutant = valid();
  const std::uint32_t place = mutant.place(SectionKind::level, 1);
  mutant.header().levels = 1;
  check_refused(mutant, VerifyRule::section_order, SectionKind::level, 1, 0, "section", place);
}

TEST_CASE("verify refuses: couplings of a layer beyond those defined") {
  ModelMutant mutant = valid();
  const std::uint32_t place = mutant.place(SectionKind::couplings, 0, layout::layers - 1) + 1;
  mutant.rebuild([&](std::vector<SectionCopy>& sections) {
    SectionCopy beyond = sections[place - 1];
    beyond.entry.b = layout::layers;
    sections.insert(sections.begin() + place, beyond);
  });
  check_refused(mutant, VerifyRule::section_order, SectionKind::couplings, 0, layout::layers, "section", place);
}

TEST_CASE("verify refuses: a file without one of its sections, whichever it is") {
  const std::size_t count = valid().table().size();
  for (std::size_t i = 0; i < count; ++i) {
    ModelMutant mutant = valid();
    const SectionEntry gone = mutant.table()[i];
    mutant.rebuild([&](std::vector<SectionCopy>& sections) { sections.erase(sections.begin() + i); });
    check_refused(mutant, VerifyRule::section_missing, static_cast<SectionKind>(gone.kind), gone.a, gone.b, "section",
                  i);
  }
}

TEST_CASE("verify refuses: a file with one of its sections twice, whichever it is") {
  const std::size_t count = valid().table().size();
  for (std::size_t i = 0; i < count; ++i) {
    ModelMutant mutant = valid();
    const SectionEntry twice = mutant.table()[i];
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      const SectionCopy copy = sections[i];
      sections.insert(sections.begin() + i + 1, copy);
    });
    check_refused(mutant, VerifyRule::section_duplicate, static_cast<SectionKind>(twice.kind), twice.a, twice.b,
                  "section", i + 1);
  }
}

TEST_CASE("verify refuses: an unknown section that is not of a newer minor version") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) { sections.push_back(unknown_section()); });
  check_refused(mutant, VerifyRule::bad_enum, static_cast<SectionKind>(unknown_kind), 0, 0, "section.kind",
                mutant.table().size() - 1);
  for (const std::uint32_t undefined : {0u, 7u, 9u, 15u}) {
    mutant.table().back().kind = undefined;
    const VerifyResult result = mutant.verdict();
    CHECK(result.rule == VerifyRule::bad_enum);
    CHECK(result.field == std::string("section.kind"));
  }
}

TEST_CASE("verify refuses: a damaged unknown section of a newer minor version") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) { sections.push_back(unknown_section()); });
  mutant.header().minor = layout::version_minor + 1;
  reseal(mutant.bytes());
  mutant.bytes()[mutant.table().back().offset] ^= std::byte{1};
  ModelView view;
  check_refusal(verify(mutant.bytes(), view), VerifyRule::section_checksum, static_cast<SectionKind>(unknown_kind), 0,
                0, "section.crc", mutant.table().size() - 1);
}

TEST_CASE("verify refuses: padding that is not zero, between sections and after the last") {
  ModelMutant mutant = valid();
  const SectionEntry provenance = mutant.entry(SectionKind::provenance);
  mutant.bytes()[provenance.offset + provenance.bytes + 1] = std::byte{1};
  check_refused(mutant, VerifyRule::padding_not_zero, header, 0, 0, "padding",
                provenance.offset + provenance.bytes + 1);
  ModelMutant last = valid();
  const std::size_t end = last.bytes().size();
  last.bytes()[end - 1] = std::byte{1};
  check_refused(last, VerifyRule::padding_not_zero, header, 0, 0, "padding", end - 1);
}

TEST_CASE("verify refuses: reserved bytes in use, in the header and in the table") {
  ModelMutant mutant = valid();
  mutant.header().reserved[23] = 1;
  check_refused(mutant, VerifyRule::reserved_not_zero, header, 0, 0, "reserved", 0);
  ModelMutant table = valid();
  table.table()[2].reserved = 1;
  check_refused(table, VerifyRule::reserved_not_zero, SectionKind::level, 0, 0, "section.reserved", 2);
}

TEST_CASE("verify: the view is plain data") { CHECK(std::is_trivially_copyable_v<ModelView>); }

}  // namespace
}  // namespace greenloop
