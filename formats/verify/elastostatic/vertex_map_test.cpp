// What VertexMap must not say, and where it must not stand.

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;
using layout::VertexRecord;

constexpr SectionKind kind = SectionKind::vertex_map;

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 3, .vertices = 20}));
  return ModelMutant(file);
}

template <class Change>
void check_vertex(VerifyRule rule, const std::string& field, std::uint64_t index, Change change) {
  ModelMutant mutant = valid();
  change(mutant.records<VertexRecord>(kind)[4]);
  check_refused(mutant, rule, kind, 0, 0, field, index);
}

TEST_CASE("verify accepts: a vertex map, which the view shows in place; a file without one is of the minor before") {
  ModelMutant with = valid(), without(SyntheticOptions{.levels = 3});
  REQUIRE(with.verdict().ok());
  CHECK(with.header().minor == 2);
  CHECK(with.view().vertices.data() == with.records<VertexRecord>(kind));
  CHECK(with.view().vertices.size() == 20);
  REQUIRE(without.verdict().ok());
  CHECK(without.header().minor == 1);
  CHECK(without.view().vertices.empty());
}

TEST_CASE("verify accepts: weights of zero and one") {
  ModelMutant mutant = valid();
  VertexRecord& record = mutant.records<VertexRecord>(kind)[4];
  record.weight[0] = 1;
  record.weight[1] = record.weight[2] = 0;
  CHECK(mutant.verdict().ok());
}

TEST_CASE("verify refuses: corners that are no nodes, or one twice") {
  ModelMutant file = valid();
  REQUIRE(file.verdict().ok());
  const std::uint32_t nodes = file.view().node_count;
  check_vertex(VerifyRule::out_of_range, "node", 13, [&](VertexRecord& record) { record.node[1] = nodes; });
  check_vertex(VerifyRule::inconsistent, "node", 14, [](VertexRecord& record) { record.node[2] = record.node[1]; });
  check_vertex(VerifyRule::inconsistent, "node", 12, [](VertexRecord& record) { record.node[0] = record.node[2]; });
}

TEST_CASE("verify refuses: weights that are not finite, negative, above one, or do not sum to one") {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  check_vertex(VerifyRule::not_finite, "weight", 14, [](VertexRecord& record) { record.weight[2] = nan; });
  check_vertex(VerifyRule::out_of_range, "weight", 12, [](VertexRecord& record) { record.weight[0] = -1e-6F; });
  check_vertex(VerifyRule::out_of_range, "weight", 13, [](VertexRecord& record) { record.weight[1] = 1.000001F; });
  check_vertex(VerifyRule::inconsistent, "weight", 12, [](VertexRecord& record) { record.weight[0] += 1e-5F; });
}

template <class Edit>
void check_rebuilt(VerifyRule rule, const std::string& field, std::uint64_t index, Edit edit) {
  ModelMutant mutant = valid();
  mutant.rebuild(edit);
  check_refused(mutant, rule, kind, 0, 0, field, index);
}

TEST_CASE("verify refuses: a vertex map that is empty, cut, twice, or not the last section") {
  check_rebuilt(VerifyRule::section_size, "bytes", 0, [](auto& sections) { sections.back().bytes.clear(); });
  check_rebuilt(VerifyRule::section_size, "bytes", 0, [](auto& sections) { sections.back().bytes.resize(47); });
  const std::uint64_t last = valid().table().size() - 1;
  check_rebuilt(VerifyRule::section_duplicate, "section", last + 1, [](auto& sections) {
    const SectionCopy map = sections.back();
    sections.push_back(map);
  });
  check_rebuilt(VerifyRule::section_order, "section", last - 1,
                [](auto& sections) { std::swap(sections[sections.size() - 2], sections.back()); });
}

TEST_CASE("verify refuses: a vertex map in a file of a minor version that had none") {
  ModelMutant mutant = valid();
  mutant.header().minor = 1;
  check_refused(mutant, VerifyRule::bad_enum, kind, 0, 0, "section.kind", mutant.table().size() - 1);
}

TEST_CASE("a model that is cut loses its vertex map, whose triangles it no longer has") {
  const auto file = encode(synthetic_model({.levels = 3, .vertices = 20}));
  ModelMutant cut(truncate_to_level(file, 1)), whole(truncate_to_level(file, 2));
  REQUIRE(cut.verdict().ok());
  CHECK(cut.view().vertices.empty());
  REQUIRE(whole.verdict().ok());
  CHECK(whole.view().vertices.size() == 20);
  // one that was cut without losing it
  cut.rebuild([&](auto& sections) {
    ModelMutant kept(file);
    const layout::SectionEntry entry = kept.entry(kind);
    const auto* bytes = kept.records<std::byte>(kind);
    sections.push_back({entry, {bytes, bytes + entry.bytes}});
  });
  check_refused(cut, VerifyRule::inconsistent, kind, 0, 0, "levels", 0);
}

}  // namespace
}  // namespace greenloop
