#include "formats/writer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "formats/testing/model_mutant.hpp"

namespace greenloop {
namespace {

template <class Record>
bool same_bytes(const Record* stored, const std::vector<Record>& given) {
  const auto a = std::as_bytes(std::span(stored, given.size()));
  const auto b = std::as_bytes(std::span(given));
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string encode_refusal(const std::function<void(ModelData&)>& change) {
  ModelData data = synthetic_model({.levels = 3});
  change(data);
  return refusal([&] { (void)encode(data); });
}

bool names(const std::string& message, const std::string& part) { return message.find(part) != std::string::npos; }

int stored_value(const CouplingsView& view, std::size_t i) {
  if (view.value_bits == 16) return reinterpret_cast<const std::int16_t*>(view.value)[i];
  if (view.value_bits == 8) return reinterpret_cast<const std::int8_t*>(view.value)[i];
  const int byte = std::to_integer<int>(view.value[i / 9 * 5 + i % 9 / 2]);
  const int nibble = (i % 9) % 2 == 0 ? byte % 16 : byte / 16;
  return nibble < 8 ? nibble : nibble - 16;
}

void check_couplings(const CouplingsView& view, const CouplingsData& data) {
  if (data.begin.empty()) {
    CHECK(view.begin == nullptr);
    return;
  }
  CHECK(view.value_bits == data.value_bits);
  CHECK(view.quantum == data.quantum);
  CHECK(same_bytes(view.begin, data.begin));
  CHECK((view.index == nullptr) == (view.index_bytes == 0));
  for (std::size_t b = 0; b < data.index.size(); ++b) {
    REQUIRE(view.index_bytes == 2);
    REQUIRE(static_cast<const std::uint16_t*>(view.index)[b] == data.index[b]);
  }
  for (std::size_t i = 0; i < data.value.size(); ++i) REQUIRE(stored_value(view, i) == data.value[i]);
}

TEST_CASE("writer: what the view shows is what was given") {
  for (const std::uint32_t bits : {4u, 8u, 16u}) {
    const ModelData data = synthetic_model({.levels = 4, .coarsest_constraint_level = 1, .strong_bits = bits});
    ModelMutant file(encode(data));
    REQUIRE(file.verdict().ok());
    const ModelView& view = file.view();
    CHECK(std::string(view.provenance.begin(), view.provenance.end()) == data.provenance);
    CHECK(view.info->young == data.info.young);
    CHECK(view.info->step_work == data.info.step_work);
    CHECK(view.info->field_layers == data.info.field_layers);
    CHECK(same_bytes(view.base_triangles, data.base_triangles));
    for (std::uint32_t q = 0; q < 4; ++q) {
      const LevelData& level = data.levels[q];
      CHECK(view.level[q].counts->rms_error == level.counts.rms_error);
      CHECK(view.level[q].counts->field_column_error == level.counts.field_column_error);
      CHECK(same_bytes(view.level[q].nodes, level.nodes));
      if (q > 0) CHECK(same_bytes(view.level[q].refinement, level.refinement));
      if (q > 0) CHECK(same_bytes(view.level[q].details, level.details));
      CHECK((view.level[q].averages == nullptr) == (q > 1));
      CHECK(same_bytes(view.level[q].averages, level.averages));
      for (std::uint32_t r = 0; r < 4; ++r) {
        CHECK((view.representatives[q][r] == nullptr) == (q == 0));
        if (q > 0) CHECK(same_bytes(view.representatives[q][r], level.representatives[r]));
      }
      for (std::size_t partner = 0; partner < 3; ++partner) {
        for (std::size_t s = 0; s < layout::strengths; ++s) {
          check_couplings(view.level[q].couplings[partner][s], level.couplings[partner][s]);
        }
      }
    }
  }
}

TEST_CASE("writer: counts, box and levels are filled in, whatever was there") {
  ModelData data = synthetic_model({.levels = 2});
  data.info.levels = 9;
  data.info.box_min[0] = 5;
  data.levels[1].counts.node_count = 77;
  data.levels[1].counts.kept_blocks = 0;
  ModelMutant file(encode(data));
  REQUIRE(file.verdict().ok());
  const ModelView& view = file.view();
  CHECK(view.info->levels == 2);
  CHECK(view.info->finest_constraint_level == 1);
  CHECK(view.info->box_min[0] == -0.1F);
  CHECK(view.info->box_max[2] == 0.1F);
  CHECK(view.node_count == 18);
  CHECK(view.domain_count == 13);
  // the scales and the ten couplings of the five domain nodes of level 0, then eight details and theirs
  CHECK(view.level[0].counts->kept_blocks == 5 + 10);
  std::size_t stored = 15 + 8;
  for (const auto& partner : data.levels[1].couplings) {
    for (const CouplingsData& couplings : partner) stored += couplings.index.size();
  }
  CHECK(view.level[1].counts->kept_blocks == stored);
  CHECK(view.level[0].counts->dense_blocks == 5 * 5);
  CHECK(view.level[1].counts->dense_blocks == 13 * 13);
}

TEST_CASE("writer: the same model gives the same bytes") {
  CHECK(encode(synthetic_model({.levels = 3})) == encode(synthetic_model({.levels = 3})));
}

TEST_CASE("writer: a cut file is a prefix but for its header and table, in one cut or several") {
  const auto whole = encode(synthetic_model({.levels = 4}));
  CHECK(truncate_to_level(whole, 3) == whole);
  for (std::uint32_t q = 0; q < 3; ++q) {
    const auto cut = truncate_to_level(whole, q);
    CHECK(cut.size() < whole.size());
    ModelMutant file(cut);
    const std::uint64_t first = file.table()[0].offset;
    CHECK(std::equal(cut.begin() + first, cut.end(), whole.begin() + first));
    CHECK(truncate_to_level(truncate_to_level(whole, q + 1), q) == cut);
  }
}

TEST_CASE("writer: refuses to cut where no valid model is left") {
  const auto file = encode(synthetic_model({.levels = 3, .coarsest_constraint_level = 1}));
  CHECK(names(refusal([&] { (void)truncate_to_level(file, 3); }), "the file ends with level 2"));
  CHECK(names(refusal([&] { (void)truncate_to_level(file, 0); }), "coarsest constraint level is 1"));
  auto damaged = file;
  damaged[300] ^= std::byte{1};
  CHECK(names(refusal([&] { (void)truncate_to_level(damaged, 1); }), "checksum"));
}

TEST_CASE("writer: keeps the sections of a newer minor version that lie within the cut") {
  ModelMutant file(encode(synthetic_model({.levels = 2})));
  SectionCopy unknown;
  unknown.entry.kind = 77;
  unknown.bytes.assign(10, std::byte{1});
  file.rebuild([&](std::vector<SectionCopy>& sections) {
    sections.insert(sections.begin() + 2, unknown);
    sections.push_back(unknown);
  });
  file.header().minor = layout::version_minor + 1;
  REQUIRE(file.verdict().ok());
  ModelMutant cut(truncate_to_level({file.bytes().begin(), file.bytes().end()}, 0));
  CHECK(cut.header().minor == layout::version_minor + 1);
  CHECK(cut.table()[2].kind == 77);
  CHECK(cut.table().back().kind != 77);
}

TEST_CASE("writer: refuses vectors that do not fit each other, by name") {
  CHECK(names(encode_refusal([](ModelData& data) { data.levels.clear(); }), "0 levels"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels.resize(13); }), "13 levels"));
  CHECK(names(encode_refusal([](ModelData& data) { data.base_triangles.pop_back(); }), "base_triangles"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].refinement.pop_back(); }), "levels[1].refinement"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].representatives.pop_back(); }),
              "levels[1].representatives"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].representatives[2].pop_back(); }),
              "levels[1].representatives[2]"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[0].averages.pop_back(); }), "levels[0].averages"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].details.pop_back(); }), "levels[2].details"));
  const auto refused = [](std::size_t partner, auto change) {
    return encode_refusal([&](ModelData& data) { change(data.levels[2].couplings[partner][0]); });
  };
  CHECK(names(refused(0, [](auto& data) { data.begin.pop_back(); }), "Couplings(2, averages, strong).begin"));
  CHECK(names(refused(1, [](auto& data) { data.index.pop_back(); }), "Couplings(2, parents, strong).index"));
  CHECK(names(refused(2, [](auto& data) { data.value.pop_back(); }), "Couplings(2, same, strong).value"));
}

TEST_CASE("writer: refuses what belongs to no section, by name") {
  CHECK(names(encode_refusal([](ModelData& data) { data.info.coarsest_constraint_level = 1; }),
              "levels[0].representatives has 3 entries, expected 0"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].averages = data.levels[0].averages; }),
              "levels[1].averages belongs to no section"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[0].details = data.levels[0].averages; }),
              "levels[0].details belongs to no section"));
  const auto misplaced = [](std::size_t q, std::size_t partner, std::size_t strength) {
    return encode_refusal([&](ModelData& data) { data.levels[q].couplings[partner][strength].begin = {0}; });
  };
  CHECK(names(misplaced(0, 0, 0), "Couplings(0, averages, strong).begin"));
  CHECK(names(misplaced(0, 2, 1), "Couplings(0, same, medium).begin"));
  CHECK(names(misplaced(1, 1, 2), "Couplings(1, parents, weak).begin"));
}

TEST_CASE("writer: refuses values that do not fit their bits") {
  const auto refused = [](std::size_t strength, auto change) {
    return encode_refusal([&](ModelData& data) { change(data.levels[2].couplings[0][strength]); });
  };
  for (const int bad : {200, -200}) {
    CHECK(names(refused(0, [&](auto& data) { data.value[4] = static_cast<std::int16_t>(bad); }),
                "Couplings(2, averages, strong).value[4] = " + std::to_string(bad)));
  }
  for (const int bad : {8, -8}) {
    CHECK(names(refused(2, [&](auto& data) { data.value[4] = static_cast<std::int16_t>(bad); }),
                "Couplings(2, averages, weak).value[4] = " + std::to_string(bad)));
  }
  CHECK(names(refused(0, [](auto& data) { data.value_bits = 5; }), "value_bits = 5"));
  CHECK(
      names(refused(0, [](auto& data) { data.index[4] = 65536; }), "Couplings(2, averages, strong).index[4] = 65536"));
}

TEST_CASE("writer: refuses whatever verify would refuse, in its words") {
  CHECK(names(encode_refusal([](ModelData& data) { data.info.young = 0; }), "Info, field `young`"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].details[3].root[0] = -1; }),
              "Scales(details, 2), field `root`, index 3"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].couplings[2][2].quantum = 2; }),
              "Couplings(2, same, weak), field `quantum`"));
}

}  // namespace
}  // namespace greenloop
