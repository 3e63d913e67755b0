// What Info, Provenance, Level, Nodes, BaseTriangles, Refinement, Representatives and Scales must not say.

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/testing/smallest_model.hpp"

namespace greenloop {
namespace {

using layout::Info;
using layout::Level;
using layout::NodeRecord;
using layout::RefinementRecord;
using layout::SectionKind;
using layout::StencilRecord;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t all_ones = 0xffffffff;

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(synthetic_model({.levels = 2}));
  return ModelMutant(file);
}

template <class Change>
void check_info(VerifyRule rule, const std::string& field, std::uint64_t index, Change change) {
  ModelMutant mutant = valid();
  change(*mutant.records<Info>(SectionKind::info));
  check_refused(mutant, rule, SectionKind::info, 0, 0, field, index);
}

template <class Change>
void check_level(std::uint32_t q, VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(*mutant.records<Level>(SectionKind::level, q));
  check_refused(mutant, rule, SectionKind::level, q, 0, field, 0);
}

template <class Change>
void check_node(std::uint32_t i, VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(mutant.records<NodeRecord>(SectionKind::nodes, 1)[i]);
  check_refused(mutant, rule, SectionKind::nodes, 1, 0, field, i);
}

template <class Change>
void check_parent(std::uint32_t i, VerifyRule rule, const std::string& field, Change change) {
  ModelMutant mutant = valid();
  change(mutant.records<RefinementRecord>(SectionKind::refinement, 1)[i]);
  check_refused(mutant, rule, SectionKind::refinement, 1, 0, field, i);
}

template <class Change>
void check_scale(std::uint32_t q, std::uint32_t i, VerifyRule rule, Change change) {
  ModelMutant root = valid(), diagonal = valid();
  change(root.records<layout::Scale<3>>(SectionKind::scales, q)[i].root);
  check_refused(root, rule, SectionKind::scales, q, 0, "root", i);
  change(diagonal.records<layout::Scale<3>>(SectionKind::scales, q)[i].diagonal);
  check_refused(diagonal, rule, SectionKind::scales, q, 0, "diagonal", i);
}

void check_representative(std::uint32_t c, std::uint32_t q, std::uint32_t i, VerifyRule rule, std::uint32_t value) {
  ModelMutant mutant = valid();
  mutant.records<std::uint32_t>(SectionKind::representatives, c, q)[i] = value;
  check_refused(mutant, rule, SectionKind::representatives, c, q, "node", i);
}

TEST_CASE("verify refuses: sections whose size does not follow from the counts") {
  const struct {
    SectionKind kind;
    std::uint32_t a, b;
  } sized[] = {{SectionKind::info, 0, 0},       {SectionKind::level, 0, 0},
               {SectionKind::nodes, 1, 0},      {SectionKind::base_triangles, 0, 0},
               {SectionKind::refinement, 1, 0}, {SectionKind::representatives, 0, 1},
               {SectionKind::scales, 0, 0},     {SectionKind::scales, 1, 0}};
  for (const auto& section : sized) {
    for (const int change : {-4, 4}) {
      ModelMutant mutant = valid();
      mutant.rebuild([&](std::vector<SectionCopy>& sections) {
        for (SectionCopy& copy : sections) {
          if (copy.is(section.kind, section.a, section.b)) copy.bytes.resize(copy.bytes.size() + change);
        }
      });
      check_refused(mutant, VerifyRule::section_size, section.kind, section.a, section.b, "bytes", 0);
    }
  }
}

TEST_CASE("verify refuses: an unknown wavelet") {
  check_info(VerifyRule::bad_enum, "wavelet", 0, [](Info& info) { info.wavelet = 6; });
  check_info(VerifyRule::bad_enum, "wavelet", 0, [](Info& info) { info.wavelet = 0; });
}

TEST_CASE("verify refuses: other than three components") {
  check_info(VerifyRule::inconsistent, "components", 0, [](Info& info) { info.components = 1; });
}

TEST_CASE("verify refuses: more levels than there can be, or fewer than the file holds") {
  check_info(VerifyRule::out_of_range, "levels", 0, [](Info& info) { info.levels = layout::max_levels + 1; });
  check_info(VerifyRule::inconsistent, "levels", 0, [](Info& info) { info.levels = 1; });
}

TEST_CASE("verify refuses: impossible material constants") {
  for (const double young : {0.0, -1.0}) {
    check_info(VerifyRule::out_of_range, "young", 0, [&](Info& info) { info.young = young; });
  }
  for (const double poisson : {-1.0, 0.5, 1e300}) {
    check_info(VerifyRule::out_of_range, "poisson", 0, [&](Info& info) { info.poisson = poisson; });
  }
  for (const double bad : {nan, infinity, -infinity}) {
    check_info(VerifyRule::not_finite, "young", 0, [&](Info& info) { info.young = bad; });
    check_info(VerifyRule::not_finite, "poisson", 0, [&](Info& info) { info.poisson = bad; });
  }
}

TEST_CASE("verify refuses: a threshold, an asymmetry or an eigenvalue that is negative or not finite") {
  check_info(VerifyRule::out_of_range, "threshold", 0, [](Info& info) { info.threshold = -1e-9; });
  check_info(VerifyRule::not_finite, "threshold", 0, [](Info& info) { info.threshold = nan; });
  check_info(VerifyRule::out_of_range, "store_asymmetry", 0, [](Info& info) { info.store_asymmetry = -1e-9; });
  check_info(VerifyRule::not_finite, "store_asymmetry", 0, [](Info& info) { info.store_asymmetry = nan; });
  check_info(VerifyRule::out_of_range, "lambda_min", 0, [](Info& info) { info.lambda_min = -1e-30; });
  check_info(VerifyRule::not_finite, "lambda_min", 0, [](Info& info) { info.lambda_min = infinity; });
}

TEST_CASE("verify refuses: a box that is inside out or not finite") {
  check_info(VerifyRule::out_of_range, "box_max", 1, [](Info& info) { info.box_max[1] = info.box_min[1] - 1; });
  check_info(VerifyRule::not_finite, "box_min", 2, [](Info& info) { info.box_min[2] = -INFINITY; });
  check_info(VerifyRule::not_finite, "box_max", 0, [](Info& info) { info.box_max[0] = NAN; });
}

TEST_CASE("verify refuses: a rate that is not positive, no contacts") {
  check_info(VerifyRule::out_of_range, "rate", 0, [](Info& info) { info.rate = 0; });
  check_info(VerifyRule::not_finite, "rate", 0, [](Info& info) { info.rate = INFINITY; });
  check_info(VerifyRule::out_of_range, "max_contacts", 0, [](Info& info) { info.max_contacts = 0; });
}

TEST_CASE("verify refuses: a share of the period that is negative, above one or not finite") {
  for (const float bad : {-0.1F, 1.0000001F}) {
    check_info(VerifyRule::out_of_range, "share", 0, [&](Info& info) { info.share = bad; });
  }
  for (const float bad : {NAN, INFINITY}) {
    check_info(VerifyRule::not_finite, "share", 0, [&](Info& info) { info.share = bad; });
  }
}

TEST_CASE("verify accepts: a share of the period, for which alone a file is of minor version 5") {
  ModelData data = smallest_model();
  REQUIRE(ModelMutant(encode(data)).header().minor == 1);
  data.info.share = 0.4F;
  ModelMutant with(encode(data));
  CHECK(with.header().minor == 5);
  REQUIRE(with.verdict().ok());
  CHECK(with.view().info->share == 0.4F);
}

TEST_CASE("verify refuses: more contacts than there may be, or than a file of its length may ask a body for") {
  check_info(VerifyRule::out_of_range, "max_contacts", 0,
             [](Info& info) { info.max_contacts = layout::most_contacts + 1; });
  const std::uint32_t nodes = 2000;
  ModelMutant mutant(encode(crowded_model(nodes, 1)));
  REQUIRE(mutant.verdict().ok());
  const auto most = static_cast<std::uint32_t>(layout::contact_pairs_per_byte * mutant.bytes().size() / nodes);
  CHECK(most > 128);
  CHECK(most < nodes);
  mutant.records<Info>(SectionKind::info)->max_contacts = most;
  CHECK(mutant.verdict().ok());
  mutant.records<Info>(SectionKind::info)->max_contacts = most + 1;
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::info, 0, 0, "max_contacts", 0);
}

TEST_CASE("verify refuses: provenance that is nested more deeply than readers of JSON may follow") {
  const auto nested = [](std::size_t depth) {
    return R"({"[": "[{\"[", "a": )" + std::string(depth - 1, '[') + std::string(depth - 1, ']') + "}";
  };
  for (const std::size_t depth : {64, 65, 20000}) {
    CAPTURE(depth);
    ModelMutant mutant = valid();
    const std::string text = nested(depth);
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      const auto bytes = std::as_bytes(std::span(text));
      sections[1].bytes.assign(bytes.begin(), bytes.end());
    });
    if (depth == 64) {
      CHECK(mutant.verdict().ok());
    } else {
      check_refused(mutant, VerifyRule::out_of_range, SectionKind::provenance, 0, 0, "nesting",
                    text.find(": [") + 2 + 63);
    }
  }
}

TEST_CASE("verify refuses: constraint levels outside the file's levels") {
  check_info(VerifyRule::out_of_range, "coarsest_constraint_level", 0,
             [](Info& info) { info.coarsest_constraint_level = 2; });
  for (const std::uint32_t finest : {0u, 2u}) {
    check_info(VerifyRule::inconsistent, "finest_constraint_level", 0,
               [&](Info& info) { info.finest_constraint_level = finest; });
  }
}

TEST_CASE("verify refuses: a quantum of any layer that is negative, above one or not finite") {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    for (const float bad : {NAN, INFINITY, -INFINITY}) {
      check_info(VerifyRule::not_finite, "quantum", layer, [&](Info& info) { info.quantum[layer] = bad; });
    }
    for (const float bad : {-1e-30F, 1.0000001F}) {
      check_info(VerifyRule::out_of_range, "quantum", layer, [&](Info& info) { info.quantum[layer] = bad; });
    }
    for (const float right : {0.0F, 1.0F}) {
      ModelMutant mutant = valid();
      mutant.records<Info>(SectionKind::info)->quantum[layer] = right;
      CHECK(mutant.verdict().ok());
    }
  }
}

TEST_CASE("verify refuses: reserved bytes of Info and Level in use") {
  check_info(VerifyRule::reserved_not_zero, "reserved", 0, [](Info& info) { info.reserved[127] = 1; });
  check_level(1, VerifyRule::out_of_range, "cut_error", [](Level& level) { level.cut_error = -1; });
}

TEST_CASE("verify refuses: provenance that is not UTF-8, or holds a zero byte") {
  for (const std::string bad : {"\x80", "\xC1\x81", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF",
                                "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xC3", "\xE2\x82", "\xE2\x28\xA1", "\xFF"}) {
    ModelMutant mutant = valid();
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      const auto text = std::as_bytes(std::span(bad));
      sections[1].bytes.resize(3);
      std::fill(sections[1].bytes.begin(), sections[1].bytes.end(), std::byte{'x'});
      sections[1].bytes.insert(sections[1].bytes.end(), text.begin(), text.end());
    });
    check_refused(mutant, VerifyRule::out_of_range, SectionKind::provenance, 0, 0, "text", 3);
  }
  ModelMutant mutant = valid();
  mutant.records<char>(SectionKind::provenance)[5] = 0;
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::provenance, 0, 0, "text", 5);
}

TEST_CASE("verify refuses: a level without nodes, or with more nodes than an index can name") {
  check_level(0, VerifyRule::out_of_range, "node_count", [](Level& level) { level.node_count = 0; });
  check_level(0, VerifyRule::out_of_range, "node_count", [](Level& level) { level.node_count = all_ones; });
  check_level(1, VerifyRule::out_of_range, "node_count", [](Level& level) { level.node_count = all_ones - 1; });
}

TEST_CASE("verify refuses: more domain nodes than nodes") {
  check_level(1, VerifyRule::out_of_range, "domain_count", [](Level& level) { level.domain_count = 13; });
}

TEST_CASE("verify refuses: a constraint level without domain nodes") {
  check_level(0, VerifyRule::inconsistent, "domain_count", [](Level& level) { level.domain_count = 0; });
}

TEST_CASE("verify refuses: base triangles on a finer level, none on the coarsest") {
  check_level(0, VerifyRule::inconsistent, "base_triangle_count", [](Level& level) { level.base_triangle_count = 0; });
  check_level(1, VerifyRule::inconsistent, "base_triangle_count", [](Level& level) { level.base_triangle_count = 8; });
}

TEST_CASE("verify refuses: block counts that the sections do not bear out, on any level, in whole and cut files") {
  const auto whole = encode(synthetic_model({.levels = 3}));
  for (const std::uint32_t last : {1u, 2u}) {
    for (std::uint32_t q = 0; q <= last; ++q) {
      for (const int change : {-1, 1}) {
        ModelMutant kept(truncate_to_level(whole, last));
        kept.records<Level>(SectionKind::level, q)->kept_blocks += change;
        check_refused(kept, VerifyRule::inconsistent, SectionKind::level, q, 0, "kept_blocks", 0);
        ModelMutant dense(truncate_to_level(whole, last));
        dense.records<Level>(SectionKind::level, q)->dense_blocks += change;
        check_refused(dense, VerifyRule::inconsistent, SectionKind::level, q, 0, "dense_blocks", 0);
      }
    }
  }
}

TEST_CASE("verify refuses: measured errors that are negative or not finite") {
  check_level(0, VerifyRule::out_of_range, "rms_error", [](Level& level) { level.rms_error = -1; });
  check_level(0, VerifyRule::not_finite, "rms_error", [](Level& level) { level.rms_error = NAN; });
  check_level(1, VerifyRule::out_of_range, "worst_column_error", [](Level& level) { level.worst_column_error = -1; });
  check_level(1, VerifyRule::not_finite, "worst_column_error", [](Level& level) { level.worst_column_error = NAN; });
  check_level(1, VerifyRule::out_of_range, "patch_force_error", [](Level& level) { level.patch_force_error = -1; });
  check_level(1, VerifyRule::not_finite, "patch_force_error", [](Level& level) { level.patch_force_error = INFINITY; });
  check_level(0, VerifyRule::out_of_range, "field_rms_error", [](Level& level) { level.field_rms_error = -1; });
  check_level(0, VerifyRule::not_finite, "field_rms_error", [](Level& level) { level.field_rms_error = NAN; });
  check_level(1, VerifyRule::out_of_range, "field_column_error", [](Level& level) { level.field_column_error = -1; });
  check_level(1, VerifyRule::not_finite, "field_column_error", [](Level& level) { level.field_column_error = NAN; });
}

TEST_CASE("verify refuses: node positions that are not finite or outside the box") {
  check_node(4, VerifyRule::not_finite, "position", [](NodeRecord& node) { node.position[1] = NAN; });
  check_node(4, VerifyRule::not_finite, "position", [](NodeRecord& node) { node.position[2] = INFINITY; });
  check_node(4, VerifyRule::out_of_range, "position", [](NodeRecord& node) { node.position[0] = 0.11F; });
  check_node(4, VerifyRule::out_of_range, "position", [](NodeRecord& node) { node.position[0] = -0.11F; });
}

TEST_CASE("verify refuses: node areas that are negative or not finite") {
  check_node(3, VerifyRule::out_of_range, "area", [](NodeRecord& node) { node.area = -1e-9F; });
  check_node(3, VerifyRule::not_finite, "area", [](NodeRecord& node) { node.area = NAN; });
}

// of the 12 nodes of level 1 the first 8 are the domain, the last 4 are fixed
TEST_CASE("verify refuses: flags that are unknown or contradict each other") {
  check_node(2, VerifyRule::bad_enum, "flags", [](NodeRecord& node) { node.flags |= 16; });
  check_node(7, VerifyRule::inconsistent, "flags.domain", [](NodeRecord& node) { node.flags &= ~1u; });
  check_node(8, VerifyRule::inconsistent, "flags.domain", [](NodeRecord& node) { node.flags |= layout::node_domain; });
  check_node(2, VerifyRule::inconsistent, "flags.fixed", [](NodeRecord& node) { node.flags |= layout::node_fixed; });
  check_node(9, VerifyRule::inconsistent, "flags.touchable",
             [](NodeRecord& node) { node.flags |= layout::node_touchable; });
  check_node(9, VerifyRule::inconsistent, "flags.read", [](NodeRecord& node) { node.flags = layout::node_read; });
}

TEST_CASE("verify refuses: base triangles with corners out of range or twice the same") {
  ModelMutant outside = valid();
  outside.records<std::uint32_t>(SectionKind::base_triangles)[5] = 6;
  check_refused(outside, VerifyRule::out_of_range, SectionKind::base_triangles, 0, 0, "corner", 5);
  for (const std::uint64_t k : {0u, 1u, 2u}) {
    ModelMutant twice = valid();
    auto* corners = twice.records<std::uint32_t>(SectionKind::base_triangles);
    corners[6 + k] = corners[6 + (k + 1) % 3];
    check_refused(twice, VerifyRule::inconsistent, SectionKind::base_triangles, 0, 0, "corner", 6 + k);
  }
}

TEST_CASE("verify refuses: parents that are not of a coarser level, or the same node") {
  check_parent(2, VerifyRule::out_of_range, "parent", [](RefinementRecord& record) { record.parent[0] = 6; });
  check_parent(2, VerifyRule::out_of_range, "parent",
               [](RefinementRecord& record) { record.parent[1] = layout::none; });
  check_parent(2, VerifyRule::inconsistent, "parent",
               [](RefinementRecord& record) { record.parent[1] = record.parent[0]; });
}

TEST_CASE("verify refuses: a domain node whose parent is neither in the domain nor fixed") {
  ModelMutant mutant = valid();
  NodeRecord& pole = mutant.records<NodeRecord>(SectionKind::nodes, 0)[5];
  REQUIRE(pole.flags == layout::node_fixed);
  pole.flags = 0;
  auto* records = mutant.records<RefinementRecord>(SectionKind::refinement, 1);
  records[3].parent[1] = 5;
  records[3].lift[1] = 0;
  check_refused(mutant, VerifyRule::inconsistent, SectionKind::refinement, 1, 0, "parent", 3);
}

TEST_CASE("verify refuses: lifting weights that are not finite, or towards a parent outside the domain") {
  check_parent(1, VerifyRule::not_finite, "lift", [](RefinementRecord& record) { record.lift[0] = NAN; });
  check_parent(1, VerifyRule::not_finite, "lift", [](RefinementRecord& record) { record.lift[1] = INFINITY; });
  check_parent(9, VerifyRule::inconsistent, "lift", [](RefinementRecord& record) {
    record.parent[1] = 5;
    record.lift[1] = 0.25F;
  });
}

TEST_CASE("verify refuses: a wavelet of a newer minor version by its name, not by the sections it brings") {
  ModelMutant mutant = valid();
  mutant.header().minor = layout::version_minor + 1;
  mutant.records<layout::Info>(SectionKind::info)->wavelet = 6;
  mutant.rebuild([](std::vector<SectionCopy>& sections) {
    SectionCopy unknown = sections.front();
    unknown.entry.kind = 77;
    sections.insert(sections.begin() + 7, unknown);
  });
  check_refused(mutant, VerifyRule::bad_enum, SectionKind::info, 0, 0, "wavelet", 0);
}

TEST_CASE("verify refuses: lifting weights where the wavelet is not lifted, accepts it without") {
  ModelMutant mutant(SyntheticOptions{.levels = 2, .wavelet = layout::Wavelet::linear});
  CHECK(mutant.verdict().ok());
  mutant.records<RefinementRecord>(SectionKind::refinement, 1)[1].lift[0] = 0.125F;
  check_refused(mutant, VerifyRule::inconsistent, SectionKind::refinement, 1, 0, "lift", 1);
}

ModelMutant butterfly() {
  return ModelMutant(SyntheticOptions{.levels = 2, .wavelet = layout::Wavelet::lifted_butterfly});
}

void check_stencil(std::uint32_t i, VerifyRule rule, void (*change)(StencilRecord&)) {
  ModelMutant mutant = butterfly();
  REQUIRE(mutant.verdict().ok());
  change(mutant.records<StencilRecord>(SectionKind::stencils, 1)[i]);
  check_refused(mutant, rule, SectionKind::stencils, 1, 0, "node", i);
}

TEST_CASE("verify refuses: more or fewer stencils than domain nodes") {
  for (const int change : {-4, 4}) {
    ModelMutant mutant = butterfly();
    mutant.rebuild([&](std::vector<SectionCopy>& sections) {
      for (SectionCopy& copy : sections) {
        if (copy.is(SectionKind::stencils, 1)) copy.bytes.resize(copy.bytes.size() + change);
      }
    });
    check_refused(mutant, VerifyRule::section_size, SectionKind::stencils, 1, 0, "bytes", 0);
  }
}

TEST_CASE("verify refuses: stencils of nodes that are not coarser, or only half there") {
  check_stencil(2, VerifyRule::out_of_range, [](StencilRecord& record) { record.outer[3] = 6; });
  check_stencil(3, VerifyRule::out_of_range, [](StencilRecord& record) { record.outer[0] = layout::none; });
  check_stencil(0, VerifyRule::inconsistent, [](StencilRecord& record) { record.wing[0] = layout::none; });
}

TEST_CASE("verify refuses: a stencil with a free node outside the domain") {
  ModelMutant mutant = butterfly();
  constexpr std::uint32_t lowest = 5;  // no domain node's parent, but in the stencils of the equator
  std::uint32_t& flags = mutant.records<NodeRecord>(SectionKind::nodes, 0)[lowest].flags;
  CHECK(flags == layout::node_fixed);
  flags = 0;
  const auto* stencils = mutant.records<StencilRecord>(SectionKind::stencils, 1);
  std::uint32_t i = 0;
  while (stencils[i].wing[0] != lowest && stencils[i].wing[1] != lowest) ++i;
  check_refused(mutant, VerifyRule::inconsistent, SectionKind::stencils, 1, 0, "node", i);
}

TEST_CASE("verify refuses: stencils where the wavelet has none, and none where it has them") {
  ModelMutant with = butterfly(), without(SyntheticOptions{.levels = 2});
  with.records<layout::Info>(SectionKind::info)->wavelet = static_cast<std::uint32_t>(layout::Wavelet::lifted_linear);
  CHECK(with.verdict().rule == VerifyRule::section_order);
  without.records<layout::Info>(SectionKind::info)->wavelet =
      static_cast<std::uint32_t>(layout::Wavelet::lifted_butterfly);
  const VerifyResult result = without.verdict();
  CHECK(result.rule == VerifyRule::section_missing);
  CHECK(result.kind == SectionKind::stencils);
}

// file indices: 0..4 the domain of level 0, 5 fixed; 6..13 the domain of level 1, 14..17 fixed
TEST_CASE("verify refuses: a representative that is not a node of the constraint level, or not in its domain") {
  check_representative(0, 1, 2, VerifyRule::out_of_range, 6);
  check_representative(0, 1, 2, VerifyRule::out_of_range, layout::none - 1);
  check_representative(0, 1, 2, VerifyRule::inconsistent, 5);
}

TEST_CASE("verify refuses: a touchable node without representative, on any constraint level") {
  check_representative(0, 0, 2, VerifyRule::inconsistent, layout::none);
  check_representative(0, 1, 2, VerifyRule::out_of_range, layout::none);
  check_representative(1, 0, 2, VerifyRule::inconsistent, layout::none);
  check_representative(1, 1, 2, VerifyRule::inconsistent, layout::none);
}

TEST_CASE("verify refuses: a node of the constraint level that another stands for") {
  check_representative(0, 0, 2, VerifyRule::inconsistent, 3);
  check_representative(1, 0, 2, VerifyRule::inconsistent, 8);
  check_representative(1, 1, 2, VerifyRule::inconsistent, 7);
}

TEST_CASE("verify refuses: a representative of a node that cannot be touched") {
  check_representative(0, 0, 5, VerifyRule::inconsistent, 0);
  check_representative(0, 1, 9, VerifyRule::inconsistent, 5);
}

TEST_CASE("verify refuses: scales that are not finite") {
  for (std::uint32_t k = 0; k < 6; ++k) {
    for (const float bad : {NAN, INFINITY, -INFINITY}) {
      check_scale(0, 3, VerifyRule::not_finite, [&](float* six) { six[k] = bad; });
      check_scale(1, 7, VerifyRule::not_finite, [&](float* six) { six[k] = bad; });
    }
  }
}

TEST_CASE("verify refuses: scales that are not positive definite, by their first, second or third minor") {
  const float not_definite[][6] = {{0, 0, 0, 1, 0, 1}, {-1, 0, 0, 1, 0, 1}, {1, 0, 0, -1, 0, 1},
                                   {1, 1, 0, 1, 0, 1}, {1, 0, 0, 1, 0, -1}, {1, 0, 0, 1, 0, 0},
                                   {1, 0, 1, 1, 0, 1}, {1, 0, 0, 1, -1, 1}, {4, 2, 6, 5, 7, 13}};
  for (const auto& bad : not_definite) {
    const auto set = [&](float* six) { std::copy(std::begin(bad), std::end(bad), six); };
    check_scale(0, 4, VerifyRule::out_of_range, set);
    check_scale(1, 0, VerifyRule::out_of_range, set);
  }
}

TEST_CASE("verify accepts: any positive definite scale, however small or skewed") {
  const float definite[][6] = {{1e-40F, 0, 0, 1e-40F, 0, 1e-40F}, {1e38F, 0, 0, 1e38F, 0, 1e38F}, {4, 2, 6, 5, 7, 14}};
  for (const auto& six : definite) {
    ModelMutant mutant = valid();
    std::copy(std::begin(six), std::end(six), mutant.records<layout::Scale<3>>(SectionKind::scales, 1)[2].root);
    std::copy(std::begin(six), std::end(six), mutant.records<layout::Scale<3>>(SectionKind::scales, 1)[3].diagonal);
    CHECK(mutant.verdict().ok());
  }
}

}  // namespace
}  // namespace greenloop
