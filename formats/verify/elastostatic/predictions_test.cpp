// What Predictions must not say.

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::PredictionsHeader;
using layout::SectionKind;

constexpr std::uint32_t level = 2;

ModelData equilibrated_model() { return synthetic_model({.levels = 3, .wavelet = layout::Wavelet::equilibrated}); }

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(equilibrated_model());
  return ModelMutant(file);
}

PredictionsHeader& header(ModelMutant& mutant) {
  return *mutant.records<PredictionsHeader>(SectionKind::predictions, level);
}

template <class Change>
void check_header(VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(header(mutant));
  check_refused(mutant, rule, SectionKind::predictions, level, 0, field, 0);
}

TEST_CASE("verify accepts: predictions with 3x3 weights; the view shows them where they stand") {
  const ModelData data = equilibrated_model();
  ModelMutant mutant = valid();
  REQUIRE(mutant.verdict().ok());
  CHECK(mutant.view().level[0].predictions.weight == nullptr);
  for (std::uint32_t q = 1; q < 3; ++q) {
    const PredictionsView& view = mutant.view().level[q].predictions;
    const PredictionsData& expected = data.levels[q].predictions;
    CHECK(view.terms == 4);
    CHECK(view.index_bytes == 2);
    const auto& at = *mutant.records<PredictionsHeader>(SectionKind::predictions, q);
    CHECK(view.weight == mutant.records<std::byte>(SectionKind::predictions, q, 0, at.weight_offset));
    REQUIRE(expected.index.size() == 4 * mutant.view().level[q].counts->domain_count);
    for (std::size_t k = 0; k < expected.index.size(); ++k) {
      REQUIRE(stored_source(view, k) == expected.index[k]);
      for (std::uint32_t e = 0; e < 9; ++e) REQUIRE(stored_weight<3>(view, k, e) == expected.weight[9 * k + e]);
    }
  }
}

TEST_CASE("verify accepts: predictions from nothing") {
  ModelData data = equilibrated_model();
  data.levels[1].predictions = {};
  ModelMutant mutant(encode(data));
  REQUIRE(mutant.verdict().ok());
  CHECK(mutant.view().level[1].predictions.terms == 0);
}

TEST_CASE("verify refuses: a header of predictions that contradicts the level") {
  check_header(VerifyRule::inconsistent, "nodes", [](PredictionsHeader& h) { ++h.nodes; });
  check_header(VerifyRule::inconsistent, "rows", [](PredictionsHeader& h) { --h.rows; });
  check_header(VerifyRule::out_of_range, "terms", [](PredictionsHeader& h) { h.terms = 9; });
  check_header(VerifyRule::out_of_range, "terms", [](PredictionsHeader& h) { h.terms = layout::none; });
  check_header(VerifyRule::bad_enum, "index_bytes", [](PredictionsHeader& h) { h.index_bytes = 3; });
  check_header(VerifyRule::inconsistent, "index_offset", [](PredictionsHeader& h) { h.index_offset += 64; });
  check_header(VerifyRule::inconsistent, "weight_offset", [](PredictionsHeader& h) { h.weight_offset -= 64; });
  check_header(VerifyRule::inconsistent, "weight_offset", [](PredictionsHeader& h) { h.index_bytes = 4; });
  check_header(VerifyRule::reserved_not_zero, "reserved", [](PredictionsHeader& h) { h.reserved[7] = 1; });
}

TEST_CASE("verify refuses: more terms than the section has room for") {
  ModelMutant mutant = valid();
  header(mutant).terms = 8;
  CHECK_FALSE(mutant.verdict().ok());
}

TEST_CASE("verify refuses: predictions that are cut, or without the room that wide loads need") {
  for (const std::size_t bytes : {std::size_t{0}, sizeof(PredictionsHeader) - 1, std::size_t{200}}) {
    ModelMutant mutant = valid();
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& copy : sections) {
        if (copy.is(SectionKind::predictions, level)) copy.bytes.resize(bytes);
      }
    });
    check_refused(mutant, VerifyRule::section_size, SectionKind::predictions, level, 0, "bytes", 0);
  }
  ModelMutant mutant = valid();
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    for (SectionCopy& copy : sections) {
      if (copy.is(SectionKind::predictions, level)) copy.bytes.resize(copy.bytes.size() - 1);
    }
  });
  check_refused(mutant, VerifyRule::section_size, SectionKind::predictions, level, 0, "bytes", 0);
}

TEST_CASE("verify refuses: predictions from a node that is not coarser") {
  ModelMutant mutant = valid();
  auto* index = mutant.records<std::uint16_t>(SectionKind::predictions, level, 0, sizeof(PredictionsHeader));
  index[5] = static_cast<std::uint16_t>(header(mutant).rows);
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::predictions, level, 0, "index", 5);
}

TEST_CASE("verify refuses: a weight without a counterpart, and padding that is not zero") {
  ModelMutant mutant = valid();
  const std::uint64_t begin = header(mutant).weight_offset;
  mutant.records<std::int16_t>(SectionKind::predictions, level, 0, begin)[11] =
      std::numeric_limits<std::int16_t>::min();
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::predictions, level, 0, "weight", 11);

  ModelMutant behind = valid();
  const std::uint64_t last = behind.entry(SectionKind::predictions, level).bytes - 1;
  *behind.records<std::byte>(SectionKind::predictions, level, 0, last) = std::byte{1};
  const std::uint64_t end = begin + std::uint64_t{18} * header(behind).nodes * header(behind).terms;
  check_refused(behind, VerifyRule::padding_not_zero, SectionKind::predictions, level, 0, "padding", end);
}

TEST_CASE("verify refuses: predictions where the wavelet has none, and none where it has them") {
  ModelMutant with = valid(), without(SyntheticOptions{.levels = 2});
  with.records<layout::Info>(SectionKind::info)->wavelet = static_cast<std::uint32_t>(layout::Wavelet::linear);
  CHECK(with.verdict().rule == VerifyRule::section_order);
  without.records<layout::Info>(SectionKind::info)->wavelet = static_cast<std::uint32_t>(layout::Wavelet::equilibrated);
  const VerifyResult result = without.verdict();
  CHECK(result.rule == VerifyRule::inconsistent);  // lifting weights come first
}

TEST_CASE("models to be written with predictions that do not fit are refused by name") {
  const auto refusal = [](void (*change)(PredictionsData&)) -> std::string {
    ModelData data = equilibrated_model();
    change(data.levels[level].predictions);
    try {
      (void)encode(data);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal([](PredictionsData& data) { data.index.pop_back(); }).find("levels[2].predictions.index") !=
        std::string::npos);
  CHECK(refusal([](PredictionsData& data) { data.weight.push_back(0); }).find("levels[2].predictions.weight") !=
        std::string::npos);
  CHECK(refusal([](PredictionsData& data) { data.index[0] = 70000; }).find("does not fit in 2 bytes") !=
        std::string::npos);
}

}  // namespace
}  // namespace greenloop
