#include "formats/write/writer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <iterator>
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

int stored_value(const CouplingsView& view, std::uint32_t value_bits, std::size_t i) {
  if (value_bits == 16) return reinterpret_cast<const std::int16_t*>(view.value)[i];
  if (value_bits == 8) return reinterpret_cast<const std::int8_t*>(view.value)[i];
  const int byte = std::to_integer<int>(view.value[i / 9 * 5 + i % 9 / 2]);
  const int nibble = (i % 9) % 2 == 0 ? byte % 16 : byte / 16;
  return nibble < 8 ? nibble : nibble - 16;
}

void check_couplings(const CouplingsView& view, std::uint32_t value_bits, const CouplingsData& data) {
  if (data.index.empty()) {
    CHECK(view.columns == 0);
    return;
  }
  CHECK(same_bytes(view.begin, data.begin));
  REQUIRE(view.index_bytes == 2);
  for (std::size_t b = 0; b < data.index.size(); ++b) {
    REQUIRE(static_cast<const std::uint16_t*>(view.index)[b] == data.index[b]);
  }
  for (std::size_t i = 0; i < data.value.size(); ++i) REQUIRE(stored_value(view, value_bits, i) == data.value[i]);
}

TEST_CASE("writer: what the view shows is what was given") {
  for (const layout::Wavelet kind : layout::wavelets) {
    const ModelData data = synthetic_model({.levels = 4, .coarsest_constraint_level = 1, .wavelet = kind});
    ModelMutant file(encode(data));
    REQUIRE(file.verdict().ok());
    const ModelView& view = file.view();
    CHECK(std::string(view.provenance.begin(), view.provenance.end()) == data.provenance);
    CHECK(view.info->wavelet == data.info.wavelet);
    CHECK(view.info->young == data.info.young);
    CHECK(view.info->step_work == data.info.step_work);
    CHECK(std::equal(std::begin(view.info->quantum), std::end(view.info->quantum), std::begin(data.info.quantum)));
    CHECK(same_bytes(view.base_triangles, data.base_triangles));
    for (std::uint32_t q = 0; q < 4; ++q) {
      const LevelData& level = data.levels[q];
      CHECK(view.level[q].counts->rms_error == level.counts.rms_error);
      CHECK(view.level[q].counts->field_column_error == level.counts.field_column_error);
      CHECK(same_bytes(view.level[q].nodes, level.nodes));
      if (q > 0) CHECK(same_bytes(view.level[q].refinement, level.refinement));
      CHECK(level.stencils.empty() == (q == 0 || !layout::is_butterfly(kind)));
      CHECK((view.level[q].stencils == nullptr) == level.stencils.empty());
      CHECK((level.stencils.empty() || same_bytes(view.level[q].stencils, level.stencils)));
      CHECK(level.predictions.index.empty() == (q == 0 || kind != layout::Wavelet::equilibrated));
      CHECK((view.level[q].predictions.weight == nullptr) == level.predictions.index.empty());
      CHECK(same_bytes(static_cast<const float*>(view.level[q].scales), level.scales.numbers));
      for (std::uint32_t r = 0; r < 4; ++r) {
        CHECK((view.representatives[q][r] == nullptr) == (q == 0));
        if (q > 0) CHECK(same_bytes(view.representatives[q][r], level.representatives[r]));
      }
      for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
        check_couplings(view.level[q].couplings[layer], layout::value_bits[layer], level.couplings[layer]);
      }
    }
  }
}

TEST_CASE("writer: loads and their columns are those given, and as long as the domain") {
  ModelData data = synthetic_model({.levels = 3, .gravity = true, .pressures = 1});
  data.info.loads = 77;
  ModelMutant file(encode(data));
  REQUIRE(file.verdict().ok());
  CHECK(same_bytes(file.view().loads.data(), data.loads));
  for (std::uint32_t q = 0; q < 3; ++q) {
    CHECK(!data.levels[q].load_columns.empty());
    CHECK(same_bytes(file.view().level[q].load_columns, data.levels[q].load_columns));
  }
  CHECK(names(encode_refusal([](ModelData& without) {
                without.levels[1].load_columns = {1, 2, 3};
              }),
              "levels[1].load_columns has 3 entries, expected 0"));
  data.loads.pop_back();
  CHECK(names(refusal([&] { (void)encode(data); }), "levels[0].load_columns has"));
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
  // five domain nodes on level 0, all coupled, then eight on level 1
  std::size_t stored = 0;
  for (const CouplingsData& layer : data.levels[0].couplings) stored += layer.index.size();
  CHECK(stored == 10);
  CHECK(view.level[0].counts->kept_blocks == 5 + stored);
  for (const CouplingsData& layer : data.levels[1].couplings) stored += layer.index.size();
  CHECK(view.level[1].counts->kept_blocks == 5 + 8 + stored);
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
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].stencils.emplace_back(); }), "levels[1].stencils"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].representatives.pop_back(); }),
              "levels[1].representatives"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].representatives[2].pop_back(); }),
              "levels[1].representatives[2]"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].scales.numbers.pop_back(); }), "levels[2].scales"));
  CHECK(names(encode_refusal([](ModelData& data) { data.info.coarsest_constraint_level = 1; }),
              "levels[0].representatives has 3 entries, expected 0"));
  for (std::size_t layer = 0; layer < layout::layers; ++layer) {
    const auto refused = [&](auto change) {
      return encode_refusal([&](ModelData& data) { change(data.levels[2].couplings[layer]); });
    };
    const std::string name = "Couplings(2, " + std::to_string(layer) + ")";
    CHECK(names(refused([](auto& data) { data.begin.pop_back(); }), name + ".begin"));
    CHECK(names(refused([](auto& data) { data.index.pop_back(); }), name + ".index"));
    CHECK(names(refused([](auto& data) { data.value.pop_back(); }), name + ".value"));
  }
}

TEST_CASE("writer: refuses numbers of a scalar model that are not one a node or block, and values beyond their bits") {
  const auto refused = [](auto change) {
    return refusal([&] {
      ModelData data =
          synthetic_model({.components = 1, .levels = 3, .wavelet = layout::Wavelet::equilibrated, .epsilon = 0.001});
      change(data);
      (void)encode(data);
    });
  };
  CHECK(refused([](ModelData&) {}).empty());
  CHECK(names(refused([](ModelData& data) { data.info.components = 2; }), "info.components is 2, expected 1 or 3"));
  CHECK(names(refused([](ModelData& data) { data.info.components = 3; }), "levels[0].scales has"));
  CHECK(names(refused([](ModelData& data) { data.levels[2].scales.numbers.push_back(1); }), "levels[2].scales has"));
  CHECK(names(refused([](ModelData& data) { data.levels[1].predictions.weight.pop_back(); }),
              "levels[1].predictions.weight"));
  CHECK(
      names(refused([](ModelData& data) { data.levels[2].couplings[3].value.push_back(0); }), "Couplings(2, 3).value"));
  CHECK(names(refused([](ModelData& data) { data.levels[2].couplings[3].value[1] = 8; }),
              "Couplings(2, 3).value[1] = 8 does not fit in 4 bits"));
  CHECK(names(refused([](ModelData& data) { data.info.young = 1; }), "Info, field `young`"));
}

TEST_CASE("writer: refuses values and rows that do not fit their bits") {
  const auto refused = [](std::size_t layer, auto change) {
    return encode_refusal([&](ModelData& data) { change(data.levels[2].couplings[layer]); });
  };
  for (std::size_t layer = 0; layer < layout::layers; ++layer) {
    const std::uint32_t bits = layout::value_bits[layer];
    if (bits == 16) continue;
    const int half = 1 << (bits - 1);
    for (const int bad : {half, -half - 1}) {
      CHECK(names(refused(layer, [&](auto& data) { data.value[4] = static_cast<std::int16_t>(bad); }),
                  "Couplings(2, " + std::to_string(layer) + ").value[4] = " + std::to_string(bad)));
    }
  }
  CHECK(names(refused(2, [](auto& data) { data.index[4] = 65536; }), "Couplings(2, 2).index[4] = 65536"));
}

TEST_CASE("writer: refuses whatever verify would refuse, in its words") {
  CHECK(names(encode_refusal([](ModelData& data) { data.info.young = 0; }), "Info, field `young`"));
  CHECK(names(encode_refusal([](ModelData& data) { data.info.quantum[3] = 2; }), "Info, field `quantum`, index 3"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].scales.of<3>()[3].root[0] = -1; }),
              "Scales(2), field `root`, index 3"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].couplings[0].value[7] = -32768; }),
              "Couplings(2, 0), field `value`, index 7"));
}

}  // namespace
}  // namespace greenloop
