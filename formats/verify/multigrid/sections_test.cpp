// What the sections of a multigrid model must not say.

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/synthetic_multigrid.hpp"

namespace greenloop {
namespace {

using layout::MultigridInfo;
using layout::SectionKind;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

ModelMutant valid() {
  static const ModelFile file = encoded_file(synthetic_multigrid({}));
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

template <class Value>
void check_value(SectionKind kind, std::uint64_t i, Value value, VerifyRule rule, const std::string& field,
                 std::uint32_t a = 0) {
  check_record<Value>(
      kind, i, rule, field, [&](Value& of_file) { of_file = value; }, a);
}

TEST_CASE("verify accepts a multigrid model, written the same each time, and no cut one") {
  ModelMutant mutant = valid();
  REQUIRE(mutant.verdict().ok());
  CHECK(mutant.header().minor == 9);
  CHECK(mutant.view().problem == layout::Problem::multigrid);
  CHECK(mutant.view().info == nullptr);
  const MultigridView& view = mutant.view().multigrid;
  CHECK(view.info->vertices == 12);
  CHECK(view.info->free == 8);
  CHECK(view.tetrahedra.size() == 12);
  CHECK(view.grid[0].vertices == 8);
  CHECK(view.grid[1].vertices == 4);
  CHECK(view.info->coarsest_vertices == 2);
  CHECK(view.coarsest_factor.size() == 21);
  const ModelFile again = encoded_file(synthetic_multigrid({}));
  CHECK(again.bytes.size() == mutant.bytes().size());
  CHECK(std::memcmp(again.bytes.data(), valid().bytes().data(), again.bytes.size()) == 0);
  mutant.rebuild([](std::vector<SectionCopy>& sections) { sections.pop_back(); });
  CHECK_FALSE(mutant.verdict().ok());
}

TEST_CASE("a model of a minor version before is no multigrid model") {
  ModelMutant mutant = valid();
  mutant.header().minor = 8;
  CHECK(mutant.verdict().rule == VerifyRule::bad_enum);
}

TEST_CASE("Info of a multigrid model must not say") {
  const auto check = [](VerifyRule rule, const std::string& field, auto change) {
    check_record<MultigridInfo>(SectionKind::info, 0, rule, field, change);
  };
  check(VerifyRule::out_of_range, "strain", [](auto& info) { info.strain = 3; });
  check(VerifyRule::out_of_range, "vertices", [](auto& info) { info.vertices = 3; });
  check(VerifyRule::out_of_range, "vertices", [](auto& info) { info.vertices = 0xffffffff; });
  check(VerifyRule::out_of_range, "free", [](auto& info) { info.free = 13; });
  check(VerifyRule::out_of_range, "free", [](auto& info) { info.free = 0; });
  check(VerifyRule::out_of_range, "tetrahedra", [](auto& info) { info.tetrahedra = 0; });
  check(VerifyRule::out_of_range, "matters", [](auto& info) { info.matters = 257; });
  check(VerifyRule::out_of_range, "grids", [](auto& info) { info.grids = 13; });
  check(VerifyRule::out_of_range, "grids", [](auto& info) { info.grids = 0; });
  check(VerifyRule::out_of_range, "coarsest_vertices", [](auto& info) { info.coarsest_vertices = 513; });
  check(VerifyRule::inconsistent, "components", [](auto& info) { info.components = 1; });
  check(VerifyRule::inconsistent, "coarsest_vertices", [](auto& info) { info.grids = 1; });
  check(VerifyRule::out_of_range, "time_step", [](auto& info) { info.time_step = 0; });
  check(VerifyRule::not_finite, "time_step", [](auto& info) { info.time_step = static_cast<double>(nan); });
  check(VerifyRule::out_of_range, "mass_damping", [](auto& info) { info.mass_damping = -1; });
  check(VerifyRule::not_finite, "stiffness_damping", [](auto& info) { info.stiffness_damping = nan; });
  check(VerifyRule::out_of_range, "numerical_damping", [](auto& info) { info.numerical_damping = 2; });
  check(VerifyRule::out_of_range, "size", [](auto& info) { info.size = 0; });
  check(VerifyRule::not_finite, "gravity", [](auto& info) { info.gravity[1] = nan; });
  check(VerifyRule::reserved_not_zero, "reserved", [](auto& info) { info.reserved[5] = 1; });
}

TEST_CASE("the body of a multigrid model must not say") {
  check_value(SectionKind::points, 4, nan, VerifyRule::not_finite, "position");
  check_value(SectionKind::shown_points, 1, nan, VerifyRule::not_finite, "position");
  check_value(SectionKind::shown_triangles, 2, 3U, VerifyRule::out_of_range, "vertex");
  using Tetrahedron = layout::TetrahedronRecord;
  check_record<Tetrahedron>(SectionKind::tetrahedra, 3, VerifyRule::out_of_range, "vertex",
                            [](auto& record) { record.vertex[1] = 12; });
  check_record<Tetrahedron>(SectionKind::tetrahedra, 3, VerifyRule::out_of_range, "matter",
                            [](auto& record) { record.matter = 1; });
  check_record<Tetrahedron>(SectionKind::tetrahedra, 3, VerifyRule::out_of_range, "volume",
                            [](auto& record) { std::swap(record.vertex[0], record.vertex[1]); });
  using Matter = layout::MatterRecord;
  check_record<Matter>(SectionKind::matters, 0, VerifyRule::out_of_range, "mu", [](auto& m) { m.mu = 0; });
  check_record<Matter>(SectionKind::matters, 0, VerifyRule::out_of_range, "lambda", [](auto& m) { m.lambda = -m.mu; });
  check_record<Matter>(SectionKind::matters, 0, VerifyRule::out_of_range, "density", [](auto& m) { m.density = 0; });
  using Binding = layout::BindingRecord;
  check_record<Binding>(SectionKind::bindings, 1, VerifyRule::out_of_range, "vertex",
                        [](auto& binding) { binding.vertex[3] = 12; });
  check_record<Binding>(SectionKind::bindings, 1, VerifyRule::not_finite, "weight",
                        [](auto& binding) { binding.weight[2] = nan; });
}

TEST_CASE("the grids of a multigrid model must not say") {
  using Grid = layout::GridRecord;
  check_record<Grid>(SectionKind::grid, 0, VerifyRule::inconsistent, "vertices", [](auto& g) { g.vertices = 7; });
  check_record<Grid>(
      SectionKind::grid, 0, VerifyRule::inconsistent, "vertices", [](auto& g) { g.vertices = 3; }, 1);
  check_record<Grid>(SectionKind::grid, 0, VerifyRule::out_of_range, "coarser", [](auto& g) { g.coarser = 9; });
  check_record<Grid>(
      SectionKind::grid, 0, VerifyRule::inconsistent, "coarser", [](auto& g) { g.coarser = 3; }, 1);
  check_record<Grid>(SectionKind::grid, 0, VerifyRule::out_of_range, "blocks", [](auto& g) { g.blocks = 1U << 30; });
  check_value(SectionKind::row_starts, 2, 0U, VerifyRule::inconsistent, "start");
  check_value(SectionKind::row_starts, 8, 99U, VerifyRule::inconsistent, "start");
  check_value(SectionKind::row_uppers, 2, 1U, VerifyRule::out_of_range, "upper");
  check_value(SectionKind::columns, 1, 8U, VerifyRule::out_of_range, "column");
  check_value(SectionKind::columns, 1, 1U, VerifyRule::inconsistent, "column");
  check_value(SectionKind::columns, 2, 0U, VerifyRule::inconsistent, "column");
  check_value(SectionKind::blocks, 5, nan, VerifyRule::not_finite, "number");
  check_value(SectionKind::blocks, 3, 1.0F, VerifyRule::inconsistent, "number");
  check_value(SectionKind::inverses, 7, 1.0F, VerifyRule::inconsistent, "number");
  check_value(SectionKind::parent_starts, 1, 9U, VerifyRule::inconsistent, "start");
  check_value(SectionKind::parents, 1, 4U, VerifyRule::out_of_range, "parent");
  check_value(SectionKind::parents, 1, 2U, VerifyRule::out_of_range, "parent", 1);
  check_value(SectionKind::weights, 1, nan, VerifyRule::not_finite, "weight");
  check_value(SectionKind::coarsest_factor, 1, std::numeric_limits<double>::infinity(), VerifyRule::not_finite,
              "number");
  check_value(SectionKind::coarsest_factor, 2, 0.0, VerifyRule::out_of_range, "number");
}

}  // namespace
}  // namespace greenloop
