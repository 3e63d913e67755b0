// What the sections of an impulse response model must not say.

#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/testing/synthetic_motion.hpp"

namespace greenloop {
namespace {

using layout::ImpulseInfo;
using layout::ImpulseLevel;
using layout::ImpulseRecord;
using layout::ModeRecord;
using layout::none;
using layout::OrbitRecord;
using layout::ReferenceRecord;
using layout::SectionKind;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

ModelMutant valid() {
  static const ModelFile file = encoded_file(synthetic_motion({.planes = 2, .alternating = true, .transfer_modes = 3}));
  return ModelMutant(file.bytes.span());
}

// One wrong record of a section is refused by rule, section and field.
template <class Record, class Change>
void check_record(SectionKind kind, std::uint64_t record, VerifyRule rule, const std::string& field, Change change,
                  std::uint32_t a = 0) {
  ModelMutant mutant = valid();
  change(mutant.records<Record>(kind, a)[record]);
  const VerifyResult result = mutant.verdict();
  CHECK_MESSAGE(result.rule == rule, field, ": ", static_cast<int>(result.rule));
  CHECK(result.kind == kind);
  CHECK(std::string(result.field) == field);
}

TEST_CASE("verify accepts an impulse response model, and a prefix of it") {
  ModelMutant mutant = valid();
  REQUIRE(mutant.verdict().ok());
  CHECK(mutant.view().impulse_response.levels == 2);
  CHECK(mutant.view().impulse_response.modes == 6);
  CHECK(mutant.view().impulse_response.appearance.modes == 3);
  const std::uint32_t second = mutant.place(SectionKind::level, 1);
  mutant.rebuild([&](std::vector<SectionCopy>& sections) { sections.resize(second); });
  mutant.header().levels = 1;
  REQUIRE(mutant.verdict().ok());
  CHECK(mutant.view().impulse_response.levels == 1);
  CHECK(mutant.view().impulse_response.modes == 2);
  CHECK(mutant.view().impulse_response.appearance.modes == 0);
}

TEST_CASE("verify accepts an impulse response model of the version that knew no appearance, but none with one") {
  ModelMutant mutant(encode(synthetic_motion({})));
  CHECK(mutant.header().minor == 7);
  CHECK(mutant.verdict().ok());
  ModelMutant lit = valid();
  CHECK(lit.header().minor == 8);
  lit.header().minor = 7;
  CHECK(lit.verdict().rule == VerifyRule::bad_enum);
}

TEST_CASE("a model of a minor version before is no impulse response model") {
  ModelMutant mutant = valid();
  mutant.header().minor = 6;
  CHECK(mutant.verdict().rule == VerifyRule::bad_enum);
}

TEST_CASE("Info must not say") {
  const auto check = [](VerifyRule rule, const std::string& field, auto change) {
    check_record<ImpulseInfo>(SectionKind::info, 0, rule, field, change);
  };
  check(VerifyRule::out_of_range, "planes", [](auto& info) { info.planes = 3; });
  check(VerifyRule::out_of_range, "impulses", [](auto& info) { info.impulses = 65; });
  check(VerifyRule::out_of_range, "rows", [](auto& info) { info.rows = 1; });
  check(VerifyRule::inconsistent, "components", [](auto& info) { info.components = 1; });
  check(VerifyRule::inconsistent, "levels", [](auto& info) { info.levels = 1; });
  check(VerifyRule::not_finite, "time_step", [](auto& info) { info.time_step = static_cast<double>(nan); });
  check(VerifyRule::out_of_range, "rate", [](auto& info) { info.rate = 0; });
  check(VerifyRule::out_of_range, "blend_rate", [](auto& info) { info.blend_rate = -1; });
  check(VerifyRule::out_of_range, "velocity_balance", [](auto& info) { info.velocity_balance = 0; });
  check(VerifyRule::out_of_range, "box_max", [](auto& info) { info.box_max[1] = -1; });
  check(VerifyRule::inconsistent, "modes", [](auto& info) { info.modes = 8; });
  check(VerifyRule::out_of_range, "transfer_modes", [](auto& info) { info.transfer_modes = 31; });
  check(VerifyRule::inconsistent, "transfer_states", [](auto& info) { info.transfer_states = 0; });
  check(VerifyRule::not_finite, "transfer_error", [](auto& info) { info.transfer_error = nan; });
  check(VerifyRule::out_of_range, "transfer_quantisation_error",
        [](auto& info) { info.transfer_quantisation_error = -1; });
  check(VerifyRule::reserved_not_zero, "reserved", [](auto& info) { info.reserved[139] = 1; });
}

TEST_CASE("levels, shape, triangles and quanta must not say") {
  const auto level = [](VerifyRule rule, const std::string& field, auto change) {
    check_record<ImpulseLevel>(SectionKind::level, 0, rule, field, change, 1);
  };
  level(VerifyRule::out_of_range, "modes", [](auto& at) { at.modes = 6; });
  level(VerifyRule::out_of_range, "modes", [](auto& at) { at.modes = 3; });
  level(VerifyRule::inconsistent, "mode_end", [](auto& at) { at.mode_end = 5; });
  level(VerifyRule::not_finite, "truncation_error", [](auto& at) { at.truncation_error = nan; });
  check_record<float>(SectionKind::shape, 299, VerifyRule::not_finite, "position", [](float& x) { x = nan; });
  check_record<std::uint32_t>(SectionKind::triangles, 5, VerifyRule::out_of_range, "vertex",
                              [](std::uint32_t& v) { v = 100; });
  check_record<float>(SectionKind::quanta, 6, VerifyRule::out_of_range, "quantum", [](float& x) { x = -1; });
}

TEST_CASE("impulses and their successions must not say") {
  const auto check = [](VerifyRule rule, const std::string& field, auto change) {
    check_record<ImpulseRecord>(SectionKind::impulses, 1, rule, field, change);
  };
  check(VerifyRule::out_of_range, "name", [](auto& record) { record.name[0] = 0; });
  check(VerifyRule::out_of_range, "name", [](auto& record) { record.name[1] = '\x1b'; });
  check(VerifyRule::out_of_range, "name", [](auto& record) { record.name[31] = 'x'; });
  check(VerifyRule::inconsistent, "name", [](auto& record) { record.name[5] = '0'; });
  check(VerifyRule::not_finite, "initial", [](auto& record) { record.initial[3] = nan; });
  check(VerifyRule::not_finite, "persistent", [](auto& record) { record.persistent[0] = nan; });
  check_record<std::uint8_t>(SectionKind::successions, 2, VerifyRule::out_of_range, "may_follow",
                             [](std::uint8_t& flag) { flag = 2; });
}

TEST_CASE("orbits must not say") {
  const auto check = [](std::uint64_t record, VerifyRule rule, const std::string& field, auto change) {
    check_record<OrbitRecord>(SectionKind::orbits, record, rule, field, change);
  };
  check(2, VerifyRule::inconsistent, "first_row", [](auto& orbit) { orbit.first_row += 1; });
  check(2, VerifyRule::out_of_range, "rows", [](auto& orbit) { orbit.rows = 1; });
  check(2, VerifyRule::out_of_range, "rows", [](auto& orbit) { orbit.rows = 1U << 31; });
  check(0, VerifyRule::inconsistent, "impulse", [](auto& orbit) { orbit.impulse = 0; });
  check(1, VerifyRule::inconsistent, "impulse", [](auto& orbit) { orbit.impulse = none; });
  check(1, VerifyRule::out_of_range, "impulse", [](auto& orbit) { orbit.impulse = 3; });
  check(0, VerifyRule::inconsistent, "next_orbit", [](auto& orbit) { orbit.next_orbit = 1; });
  check(1, VerifyRule::out_of_range, "next_orbit", [](auto& orbit) { orbit.next_orbit = 10; });
  check(1, VerifyRule::inconsistent, "next_orbit", [](auto& orbit) { orbit.next_orbit = 2; });
  check(1, VerifyRule::out_of_range, "next_row", [](auto& orbit) { orbit.next_row = orbit.first_row; });
  check(1, VerifyRule::out_of_range, "next_row", [](auto& orbit) { orbit.next_row = 2 + 7 * 24 - 1; });
  check(1, VerifyRule::not_finite, "next_distance", [](auto& orbit) { orbit.next_distance = nan; });
  check(1, VerifyRule::reserved_not_zero, "reserved", [](auto& orbit) { orbit.reserved[1] = 1; });
  check(9, VerifyRule::inconsistent, "rows", [](auto& orbit) { orbit.rows -= 1; });
}

TEST_CASE("references must not say") {
  const auto check = [](std::uint64_t record, VerifyRule rule, const std::string& field, auto change) {
    check_record<ReferenceRecord>(SectionKind::references, record, rule, field, change);
  };
  // row 2 is the first of an orbit of impulse 0, which may not follow itself
  check(3 * 2 + 0, VerifyRule::inconsistent, "orbit", [](auto& reference) { reference.orbit = 1; });
  check(3 * 2 + 0, VerifyRule::inconsistent, "distance", [](auto& reference) { reference.distance = 1; });
  check(3 * 2 + 1, VerifyRule::out_of_range, "orbit", [](auto& reference) { reference.orbit = none; });
  check(3 * 2 + 1, VerifyRule::inconsistent, "orbit", [](auto& reference) { reference.orbit = 3; });
  check(3 * 2 + 1, VerifyRule::out_of_range, "distance", [](auto& reference) { reference.distance = -1; });
}

TEST_CASE("modes, amplitudes and coordinates must not say") {
  check_record<std::int8_t>(SectionKind::modes, 11, VerifyRule::out_of_range, "value",
                            [](std::int8_t& value) { value = -128; });
  check_record<ModeRecord>(SectionKind::amplitudes, 1, VerifyRule::not_finite, "amplitude",
                           [](ModeRecord& mode) { mode.amplitude = nan; });
  check_record<ModeRecord>(SectionKind::amplitudes, 1, VerifyRule::out_of_range, "truncation_error",
                           [](ModeRecord& mode) { mode.truncation_error = -1; });
  check_record<std::int16_t>(SectionKind::coordinates, 5, VerifyRule::out_of_range, "coordinate",
                             [](std::int16_t& value) { value = -32768; });
}

TEST_CASE("radiance transfer must not say") {
  check_record<float>(SectionKind::transfer_quanta, 13, VerifyRule::out_of_range, "quantum", [](float& x) { x = -1; });
  check_record<ModeRecord>(SectionKind::transfer_amplitudes, 2, VerifyRule::not_finite, "amplitude",
                           [](ModeRecord& mode) { mode.amplitude = nan; });
  check_record<ModeRecord>(SectionKind::transfer_amplitudes, 2, VerifyRule::out_of_range, "truncation_error",
                           [](ModeRecord& mode) { mode.truncation_error = -1; });
  check_record<std::int16_t>(SectionKind::transfer_coordinates, 5, VerifyRule::out_of_range, "coordinate",
                             [](std::int16_t& value) { value = -32768; });
}

TEST_CASE("a section of another size, or one too few, is refused by name") {
  for (const SectionKind kind :
       {SectionKind::shape, SectionKind::triangles, SectionKind::quanta, SectionKind::impulses,
        SectionKind::successions, SectionKind::orbits, SectionKind::references, SectionKind::modes,
        SectionKind::amplitudes, SectionKind::coordinates, SectionKind::transfer_quanta, SectionKind::transfers,
        SectionKind::transfer_amplitudes, SectionKind::transfer_coordinates}) {
    ModelMutant shorter = valid(), without = valid();
    shorter.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(kind)) section.bytes.resize(section.bytes.size() - 1);
      }
    });
    VerifyResult result = shorter.verdict();
    CHECK(result.rule == VerifyRule::section_size);
    CHECK(result.kind == kind);
    without.rebuild([&](std::vector<SectionCopy>& sections) {
      std::erase_if(sections, [&](const SectionCopy& section) { return section.is(kind); });
    });
    result = without.verdict();
    CHECK(result.rule == VerifyRule::section_missing);
    CHECK(result.kind == kind);
  }
}

}  // namespace
}  // namespace greenloop
