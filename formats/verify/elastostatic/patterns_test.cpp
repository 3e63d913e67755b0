// What Patterns must not say.

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::PatternKind;
using layout::PatternRecord;
using layout::SectionKind;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

ModelData measured_model() {
  ModelData model = synthetic_model({.levels = 3, .coarsest_constraint_level = 1});
  model.levels[1].patterns = synthetic_patterns();
  return model;
}

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(measured_model());
  return ModelMutant(file);
}

template <class Change>
void check_pattern(std::uint32_t i, VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(mutant.records<PatternRecord>(SectionKind::patterns, 1)[i]);
  check_refused(mutant, rule, SectionKind::patterns, 1, 0, field, i);
}

TEST_CASE("verify accepts: patterns of some constraint levels; the view shows them where they stand") {
  ModelMutant mutant = valid();
  REQUIRE(mutant.verdict().ok());
  const LevelView* level = mutant.view().level;
  CHECK(level[0].patterns.empty());
  CHECK(level[1].patterns.data() == mutant.records<PatternRecord>(SectionKind::patterns, 1));
  CHECK(level[1].patterns.size() == synthetic_patterns().size());
  CHECK(level[2].patterns.empty());
}

TEST_CASE("verify accepts: errors of zero, the largest float, and all three alike") {
  ModelMutant mutant = valid();
  PatternRecord& record = mutant.records<PatternRecord>(SectionKind::patterns, 1)[1];
  for (float& error : record.field_error) error = 0;
  for (float& error : record.force_error) error = std::numeric_limits<float>::max();
  record.contacts = 2;
  CHECK(mutant.verdict().ok());
}

TEST_CASE("a model cut off after a level keeps the patterns of that level") {
  const auto file = encode(measured_model());
  const AlignedBytes cut(truncate_to_level(file, 1));
  ModelView view;
  REQUIRE(verify(cut.span(), view).ok());
  CHECK(view.levels == 2);
  const auto expected = synthetic_patterns();
  REQUIRE(view.level[1].patterns.size() == expected.size());
  CHECK(std::memcmp(view.level[1].patterns.data(), expected.data(), view.level[1].patterns.size_bytes()) == 0);
}

TEST_CASE("verify refuses: a constraint level without a section of patterns") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    std::erase_if(sections, [](const SectionCopy& copy) { return copy.is(SectionKind::patterns, 2); });
  });
  check_refusal(mutant.verdict(), VerifyRule::section_missing, SectionKind::patterns, 2, 0, "section",
                mutant.table().size());
}

TEST_CASE("verify refuses: patterns below the coarsest constraint level") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    SectionCopy copy = sections.back();
    copy.entry.a = 0;
    const auto next = std::find_if(sections.begin(), sections.end(),
                                   [](const SectionCopy& section) { return section.is(SectionKind::level, 1); });
    sections.insert(next, copy);
  });
  const VerifyResult result = mutant.verdict();
  check_refusal(result, VerifyRule::section_order, SectionKind::patterns, 0, 0, "section", result.index);
}

TEST_CASE("verify refuses: a part of a pattern's record") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    for (SectionCopy& copy : sections) {
      if (copy.is(SectionKind::patterns, 1)) copy.bytes.resize(copy.bytes.size() - 4);
    }
  });
  check_refused(mutant, VerifyRule::section_size, SectionKind::patterns, 1, 0, "bytes", 0);
}

TEST_CASE("verify refuses: more records of patterns than there can be") {
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    for (SectionCopy& copy : sections) {
      if (!copy.is(SectionKind::patterns, 1)) continue;
      copy.bytes.resize((layout::pattern_kinds * layout::most_pattern_contacts + 1) * sizeof(PatternRecord));
    }
  });
  check_refused(mutant, VerifyRule::section_size, SectionKind::patterns, 1, 0, "bytes", 0);
}

TEST_CASE("verify refuses: a pattern of an unknown kind") {
  check_pattern(0, VerifyRule::bad_enum, "kind", [](PatternRecord& record) { record.kind = 0; });
  check_pattern(4, VerifyRule::bad_enum, "kind", [](PatternRecord& record) { record.kind = 10; });
}

TEST_CASE("verify refuses: patterns of no contacts, of fewer than their kind needs, of too many") {
  check_pattern(0, VerifyRule::out_of_range, "contacts", [](PatternRecord& record) { record.contacts = 0; });
  check_pattern(1, VerifyRule::out_of_range, "contacts", [](PatternRecord& record) { record.contacts = 1; });
  check_pattern(4, VerifyRule::out_of_range, "contacts", [](PatternRecord& record) { record.contacts = 257; });
}

TEST_CASE("verify refuses: a pattern without samples") {
  check_pattern(2, VerifyRule::out_of_range, "samples", [](PatternRecord& record) { record.samples = 0; });
}

TEST_CASE("verify refuses: a pattern's reserved word in use") {
  check_pattern(2, VerifyRule::reserved_not_zero, "reserved", [](PatternRecord& record) { record.reserved = 1; });
}

TEST_CASE("verify refuses: errors of patterns that are not finite") {
  check_pattern(0, VerifyRule::not_finite, "field_error", [](PatternRecord& record) { record.field_error[0] = nan; });
  check_pattern(1, VerifyRule::not_finite, "field_peak",
                [](PatternRecord& record) { record.field_peak[2] = infinity; });
  check_pattern(2, VerifyRule::not_finite, "force_error", [](PatternRecord& record) { record.force_error[1] = nan; });
  check_pattern(4, VerifyRule::not_finite, "total_force_error",
                [](PatternRecord& record) { record.total_force_error[2] = infinity; });
}

TEST_CASE("verify refuses: errors of patterns below zero") {
  check_pattern(3, VerifyRule::out_of_range, "field_error", [](PatternRecord& record) { record.field_error[0] = -1; });
  check_pattern(3, VerifyRule::out_of_range, "total_force_error",
                [](PatternRecord& record) { record.total_force_error[0] = -1; });
}

TEST_CASE("verify refuses: a median above the 95th percentile, and that above the worst") {
  check_pattern(1, VerifyRule::out_of_range, "field_peak", [](PatternRecord& record) { record.field_peak[0] = 9; });
  check_pattern(2, VerifyRule::out_of_range, "force_error", [](PatternRecord& record) { record.force_error[1] = 9; });
}

TEST_CASE("verify refuses: total forces of a kind that pushes nothing as a whole") {
  check_pattern(3, VerifyRule::inconsistent, "total_force_error",
                [](PatternRecord& record) { record.total_force_error[2] = 0.5F; });
}

TEST_CASE("verify refuses: patterns twice or out of order") {
  check_pattern(2, VerifyRule::not_increasing, "contacts", [](PatternRecord& record) { record.contacts = 4; });
  check_pattern(2, VerifyRule::not_increasing, "contacts", [](PatternRecord& record) { record.contacts = 2; });
  check_pattern(4, VerifyRule::not_increasing, "contacts",
                [](PatternRecord& record) { record.kind = static_cast<std::uint32_t>(PatternKind::patch); });
}

TEST_CASE("the writer refuses: patterns of a level that is no constraint level") {
  ModelData model = measured_model();
  model.levels[0].patterns = synthetic_patterns();
  CHECK_THROWS_WITH_AS((void)encode(model), "model to be written: levels[0].patterns has 5 entries, expected 0",
                       std::invalid_argument);
}

}  // namespace
}  // namespace greenloop
