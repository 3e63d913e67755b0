// What verify demands of a scalar model: the rules of an elastostatic one with blocks of 1x1, no material, and a minor
// version that knows it.

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/testing/smallest_model.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::Info;
using layout::Problem;
using layout::SectionKind;

constexpr std::uint32_t finest = 3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

ModelData scalar_model(layout::Wavelet wavelet = layout::Wavelet::equilibrated) {
  return synthetic_model({.components = 1, .levels = finest + 1, .wavelet = wavelet});
}

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(scalar_model());
  return ModelMutant(file);
}

Info& info_of(ModelMutant& mutant) { return *mutant.records<Info>(SectionKind::info); }

template <class Value>
Value* values_of(ModelMutant& mutant, std::uint32_t layer) {
  const auto& header = *mutant.records<CouplingsHeader>(SectionKind::couplings, finest, layer);
  REQUIRE(header.block_count > 2);
  return mutant.records<Value>(SectionKind::couplings, finest, layer, header.value_offset);
}

void check_info(VerifyRule rule, const std::string& field, double Info::*member, double wrong) {
  ModelMutant mutant = valid();
  info_of(mutant).*member = wrong;
  check_refused(mutant, rule, SectionKind::info, 0, 0, field, 0);
}

TEST_CASE("verify accepts: scalar models of every wavelet, cut after any level, and the smallest") {
  std::vector<std::vector<std::byte>> files = {encode(smallest_scalar_model())};
  for (const layout::Wavelet wavelet : layout::wavelets) {
    const std::vector<std::byte> whole = encode(scalar_model(wavelet));
    files.push_back(whole);
    for (std::uint32_t q = 0; q < finest; ++q) files.push_back(truncate_to_level(whole, q));
  }
  for (const auto& file : files) {
    ModelMutant mutant(file);
    const VerifyResult result = mutant.verdict();
    CAPTURE(describe(result));
    REQUIRE(result.ok());
    CHECK(mutant.header().minor == 3);
    CHECK(mutant.view().problem == Problem::scalar);
    CHECK(mutant.view().info->components == 1);
  }
}

TEST_CASE("verify: an elastostatic model is of the minor version it was of before there were scalar ones") {
  CHECK(ModelMutant(encode(smallest_model())).header().minor == 1);
  ModelData cut = smallest_model();
  cut.levels[0].counts.cut_error = 0.5F;
  CHECK(ModelMutant(encode(cut)).header().minor == 2);
}

TEST_CASE("verify: the view of a scalar model shows its numbers as they were written") {
  const ModelData data = scalar_model();
  ModelMutant mutant = valid();
  REQUIRE(mutant.verdict().ok());
  for (std::uint32_t q = 0; q <= finest; ++q) {
    const LevelView& level = mutant.view().level[q];
    const LevelData& written = data.levels[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      CHECK(level.scales_of<1>()[i].root[0] == written.scales.of<1>()[i].root[0]);
      CHECK(level.scales_of<1>()[i].diagonal[0] == written.scales.of<1>()[i].diagonal[0]);
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const std::vector<std::int16_t>& values = written.couplings[layer].value;
      REQUIRE(block_count(level.couplings[layer]) == values.size());
      for (std::uint32_t b = 0; b < values.size(); ++b) {
        REQUIRE(stored_value<1>(level.couplings[layer], layout::value_bits[layer], b, 0) == values[b]);
      }
    }
    const std::vector<std::int16_t>& weights = written.predictions.weight;
    CHECK(weights.size() == std::size_t{4} * (q > 0 ? level.counts->domain_count : 0));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      REQUIRE(stored_weight<1>(level.predictions, k, 0) == weights[k]);
    }
  }
}

TEST_CASE("verify refuses: a scalar model of a minor version that had none") {
  for (const std::uint16_t minor : {std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2}}) {
    ModelMutant mutant = valid();
    mutant.header().minor = minor;
    check_refused(mutant, VerifyRule::bad_enum, SectionKind::info, 0, 0, "problem", 0);
  }
}

TEST_CASE("verify refuses: other than one component in a scalar model") {
  for (const std::uint32_t components : {0u, 2u, 3u}) {
    ModelMutant mutant = valid();
    info_of(mutant).components = components;
    check_refused(mutant, VerifyRule::inconsistent, SectionKind::info, 0, 0, "components", 0);
  }
}

TEST_CASE("verify refuses: a scalar model with a material") {
  for (const double wrong : {0.3, -0.3, nan}) {
    check_info(VerifyRule::inconsistent, "young", &Info::young, wrong);
    check_info(VerifyRule::inconsistent, "poisson", &Info::poisson, wrong);
  }
}

TEST_CASE("verify refuses: a model whose sections are those of the other problem") {
  ModelMutant vectors(encode(scalar_model()));
  info_of(vectors).problem = static_cast<std::uint32_t>(Problem::elastostatic);
  info_of(vectors).components = 3;
  info_of(vectors).young = 1e5;
  check_refused(vectors, VerifyRule::section_size, SectionKind::scales, 0, 0, "bytes", 0);

  ModelMutant scalars(SyntheticOptions{.levels = 2});
  scalars.header().minor = 3;
  info_of(scalars).problem = static_cast<std::uint32_t>(Problem::scalar);
  info_of(scalars).components = 1;
  info_of(scalars).young = info_of(scalars).poisson = 0;
  check_refused(scalars, VerifyRule::section_size, SectionKind::scales, 0, 0, "bytes", 0);
}

TEST_CASE("verify refuses: scalar scales that are not positive, or not finite") {
  using Scale = layout::Scale<1>;
  const auto check = [](VerifyRule rule, const std::string& field, float(Scale::*member)[1], float wrong) {
    ModelMutant mutant = valid();
    (mutant.records<Scale>(SectionKind::scales, finest)[5].*member)[0] = wrong;
    check_refused(mutant, rule, SectionKind::scales, finest, 0, field, 5);
  };
  for (const float wrong : {0.0F, -1e-20F, -1.0F}) {
    check(VerifyRule::out_of_range, "root", &Scale::root, wrong);
    check(VerifyRule::out_of_range, "diagonal", &Scale::diagonal, wrong);
  }
  for (const float wrong : {static_cast<float>(nan), std::numeric_limits<float>::infinity()}) {
    check(VerifyRule::not_finite, "root", &Scale::root, wrong);
    check(VerifyRule::not_finite, "diagonal", &Scale::diagonal, wrong);
  }
}

TEST_CASE("verify refuses: one scale more or fewer than nodes in the domain of a scalar model") {
  for (const std::size_t scales : {0U, 2U}) {  // for the last one
    ModelMutant mutant = valid();
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(SectionKind::scales, 1)) {
          section.bytes.resize(section.bytes.size() - sizeof(layout::Scale<1>) + scales * sizeof(layout::Scale<1>));
        }
      }
    });
    check_refused(mutant, VerifyRule::section_size, SectionKind::scales, 1, 0, "bytes", 0);
  }
}

TEST_CASE("verify refuses: the value without a counterpart in any layer of scalar couplings") {
  ModelMutant nibbles = valid(), bytes = valid(), words = valid();
  values_of<std::uint8_t>(nibbles, 3)[2] = 8;
  check_refused(nibbles, VerifyRule::out_of_range, SectionKind::couplings, finest, 3, "value", 2);
  values_of<std::int8_t>(bytes, 2)[2] = -128;
  check_refused(bytes, VerifyRule::out_of_range, SectionKind::couplings, finest, 2, "value", 2);
  values_of<std::int16_t>(words, 1)[2] = -32768;
  check_refused(words, VerifyRule::out_of_range, SectionKind::couplings, finest, 1, "value", 2);
}

TEST_CASE("verify refuses: a scalar block of 4 bits whose high half is not zero") {
  for (const int high : {1, 8, 15}) {
    ModelMutant mutant = valid();
    auto& block = values_of<std::uint8_t>(mutant, 3)[2];
    block = static_cast<std::uint8_t>((block & 15) | high << 4);
    check_refused(mutant, VerifyRule::padding_not_zero, SectionKind::couplings, finest, 3, "value", 2);
  }
}

TEST_CASE("verify refuses: scalar blocks that reach past the end of their section, or leave some of it") {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    CAPTURE(layer);
    ModelMutant tight = valid();
    tight.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& section : sections) {
        if (section.is(SectionKind::couplings, finest, layer)) section.bytes.pop_back();
      }
    });
    check_refused(tight, VerifyRule::section_size, SectionKind::couplings, finest, layer, "bytes", 0);

    ModelMutant used = valid();
    const auto& header = *used.records<CouplingsHeader>(SectionKind::couplings, finest, layer);
    const std::uint64_t end =
        header.value_offset + header.block_count * layout::block_bytes(1, layout::value_bits[layer]);
    *used.records<std::uint8_t>(SectionKind::couplings, finest, layer, end) = 1;
    check_refused(used, VerifyRule::padding_not_zero, SectionKind::couplings, finest, layer, "padding", end);
  }
}

TEST_CASE("verify refuses: scalar predictions without a counterpart, or that reach past the end of their section") {
  ModelMutant mutant = valid();
  const auto& header = *mutant.records<layout::PredictionsHeader>(SectionKind::predictions, finest);
  const std::uint64_t end = header.weight_offset + std::uint64_t{2} * header.nodes * header.terms;
  CHECK(mutant.entry(SectionKind::predictions, finest).bytes == end + layout::tail_bytes);
  mutant.records<std::int16_t>(SectionKind::predictions, finest, 0, header.weight_offset)[7] = -32768;
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::predictions, finest, 0, "weight", 7);

  ModelMutant tight = valid();
  tight.rebuild([](std::vector<SectionCopy>& sections) {
    for (SectionCopy& section : sections) {
      if (section.is(SectionKind::predictions, finest)) section.bytes.pop_back();
    }
  });
  check_refused(tight, VerifyRule::section_size, SectionKind::predictions, finest, 0, "bytes", 0);

  ModelMutant used = valid();
  *used.records<std::uint8_t>(SectionKind::predictions, finest, 0, end) = 1;
  check_refused(used, VerifyRule::padding_not_zero, SectionKind::predictions, finest, 0, "padding", end);
}

}  // namespace
}  // namespace greenloop
