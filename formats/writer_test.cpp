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

void check_blocks(const BlocksView& view, const BlocksData& data) {
  CHECK(view.value_bytes == data.value_bytes);
  CHECK(same_bytes(view.begin, data.begin));
  CHECK(same_bytes(view.scale, data.scale));
  for (std::size_t b = 0; b < data.index.size(); ++b) {
    REQUIRE(view.index_bytes == 2);
    REQUIRE(static_cast<const std::uint16_t*>(view.index)[b] == data.index[b]);
  }
  for (std::size_t i = 0; i < data.value.size(); ++i) {
    const int value = data.value_bytes == 1 ? static_cast<const std::int8_t*>(view.value)[i]
                                            : static_cast<const std::int16_t*>(view.value)[i];
    REQUIRE(value == data.value[i]);
  }
}

TEST_CASE("writer: what the view shows is what was given") {
  for (const std::uint32_t value_bytes : {1u, 2u}) {
    const ModelData data = synthetic_model({.levels = 3, .coarsest_constraint_level = 1, .value_bytes = value_bytes});
    ModelMutant file(encode(data));
    REQUIRE(file.verdict().ok());
    const ModelView& view = file.view();
    CHECK(std::string(view.provenance.begin(), view.provenance.end()) == data.provenance);
    CHECK(view.info->young == data.info.young);
    CHECK(view.info->step_work == data.info.step_work);
    CHECK(same_bytes(view.base_triangles, data.base_triangles));
    for (std::uint32_t q = 0; q < 3; ++q) {
      const LevelData& level = data.levels[q];
      CHECK(view.level[q].counts->rms_error == level.counts.rms_error);
      CHECK(same_bytes(view.level[q].nodes, level.nodes));
      if (q > 0) CHECK(same_bytes(view.level[q].refinement, level.refinement));
      CHECK(view.level[q].counts->column_count == level.columns.size());
      if (level.columns.empty()) continue;
      CHECK(same_bytes(view.level[q].columns, level.columns));
      for (std::uint32_t r = 0; r < 3; ++r) {
        CHECK(same_bytes(view.representatives[q][r], level.representatives[r]));
        check_blocks(view.blocks[q][r], level.blocks[r]);
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
  CHECK(view.level[1].counts->column_count == 13);
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
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].blocks.pop_back(); }), "levels[1].blocks"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].blocks[2].begin.clear(); }), "Blocks(1, 2).begin"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[1].blocks[2].scale.clear(); }), "Blocks(1, 2).scale"));
  CHECK(
      names(encode_refusal([](ModelData& data) { data.levels[1].blocks[2].index.pop_back(); }), "Blocks(1, 2).index"));
  CHECK(
      names(encode_refusal([](ModelData& data) { data.levels[1].blocks[2].value.pop_back(); }), "Blocks(1, 2).value"));
}

TEST_CASE("writer: refuses values that do not fit their bytes") {
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].blocks[1].value[4] = 200; }),
              "Blocks(2, 1).value[4] = 200"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].blocks[1].value_bytes = 4; }), "value_bytes = 4"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].blocks[1].index[4] = 65536; }),
              "Blocks(2, 1).index[4] = 65536"));
}

TEST_CASE("writer: refuses whatever verify would refuse, in its words") {
  CHECK(names(encode_refusal([](ModelData& data) { data.info.young = 0; }), "Info, field `young`"));
  CHECK(names(encode_refusal([](ModelData& data) { data.levels[2].blocks[1].scale[3] = -1; }),
              "Blocks(2, 1), field `scale`, index 3"));
}

}  // namespace
}  // namespace greenloop
