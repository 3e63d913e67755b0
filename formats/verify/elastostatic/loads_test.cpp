// What Loads and LoadColumns must not say, and what a view shows of them.

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "formats/testing/dense_wavelet.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/refusal.hpp"
#include "formats/write/ready_file.hpp"

namespace greenloop {
namespace {

using layout::LoadRecord;
using layout::SectionKind;

constexpr std::uint32_t loads = 5;

const ModelData& loaded_model() {
  static const ModelData model =
      synthetic_model({.levels = 3, .wavelet = layout::Wavelet::equilibrated, .gravity = true, .pressures = loads - 3});
  return model;
}

ModelMutant valid() {
  static const std::vector<std::byte> file = encode(loaded_model());
  return ModelMutant(file);
}

template <class Change>
void check_load(VerifyRule rule, const std::string& field, std::uint64_t index, Change change) {
  ModelMutant mutant = valid();
  change(mutant.records<LoadRecord>(SectionKind::loads)[index]);
  check_refused(mutant, rule, SectionKind::loads, 0, 0, field, index);
}

TEST_CASE("verify accepts: loads, which the view shows in place; a file without them is of the minor before") {
  ModelMutant with = valid(), without(SyntheticOptions{.levels = 3});
  REQUIRE(with.verdict().ok());
  CHECK(with.header().minor == 6);
  CHECK(with.view().has_gravity());
  CHECK(with.view().info->loads == loads);
  REQUIRE(with.view().loads.size() == loads);
  CHECK(with.view().loads.data() == with.records<LoadRecord>(SectionKind::loads));
  CHECK(std::string(with.view().loads[4].name) == "pressure 1");
  for (std::uint32_t q = 0; q < 3; ++q) {
    const auto* columns = with.records<float>(SectionKind::load_columns, q);
    CHECK(with.view().level[q].load_columns == columns);
    CHECK(with.view().level[q].load_column(2) == columns + std::size_t{6} * with.view().level[q].counts->domain_count);
  }
  REQUIRE(without.verdict().ok());
  CHECK(without.header().minor == 1);
  CHECK(without.view().loads.empty());
  CHECK(!without.view().has_gravity());
  CHECK(without.view().level[0].load_columns == nullptr);
  ModelMutant pressed(SyntheticOptions{.levels = 1, .pressures = 1});
  REQUIRE(pressed.verdict().ok());
  CHECK(!pressed.view().has_gravity());
  CHECK(pressed.view().loads.size() == 1);
}

TEST_CASE("the columns of the accelerations are the displacements under each node's mass") {
  const ModelData& model = loaded_model();
  ModelMutant file = valid();
  REQUIRE(file.verdict().ok());
  const ModelView& view = file.view();
  const DenseWavelet wavelet(model);
  for (std::uint32_t load = 0; load < 3; ++load) {
    Eigen::MatrixXd column(wavelet.rows(2), 1), forces = Eigen::MatrixXd::Zero(wavelet.rows(2), 1);
    for (std::uint32_t q = 0; q < 3; ++q) {
      for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
        const Eigen::Index row = 3 * (Eigen::Index{view.level[q].domain_begin} + i);
        for (Eigen::Index k = 0; k < 3; ++k)
          column(row + k, 0) = view.level[q].load_column(load)[Eigen::Index{3} * i + k];
        forces(row + load, 0) = 100.0 * view.level[q].nodes[i].area;
      }
    }
    for (std::uint32_t q = 1; q < 3; ++q) wavelet.inverse(q, column.topRows(wavelet.rows(q)));
    const Eigen::MatrixXd expected = decoded_compliance(model, 2) * forces;  // compressed: as far as it goes
    CHECK((column - expected).norm() < 0.01 * expected.norm());
    CHECK(view.loads[load].resultant[load] == doctest::Approx(forces.sum()));
  }
}

TEST_CASE("verify refuses: kinds that are unknown or stand where another belongs") {
  check_load(VerifyRule::bad_enum, "kind", 4, [](LoadRecord& load) { load.kind = 5; });
  check_load(VerifyRule::bad_enum, "kind", 1, [](LoadRecord& load) { load.kind = 0; });
  check_load(VerifyRule::inconsistent, "kind", 1, [](LoadRecord& load) { load.kind = 3; });
  check_load(VerifyRule::inconsistent, "kind", 0, [](LoadRecord& load) { load.kind = 2; });
  check_load(VerifyRule::inconsistent, "kind", 3, [](LoadRecord& load) { load.kind = 1; });
}

TEST_CASE("verify refuses: resultants that are not finite") {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  check_load(VerifyRule::not_finite, "resultant", 2, [](LoadRecord& load) { load.resultant[1] = infinity; });
}

TEST_CASE("verify refuses: names that are absent, of an acceleration, not printable, unended or there twice") {
  check_load(VerifyRule::inconsistent, "name", 3, [](LoadRecord& load) { std::memset(load.name, 0, 48); });
  check_load(VerifyRule::inconsistent, "name", 1, [](LoadRecord& load) { load.name[0] = 'g'; });
  check_load(VerifyRule::out_of_range, "name", 3, [](LoadRecord& load) { load.name[2] = '\n'; });
  check_load(VerifyRule::out_of_range, "name", 3, [](LoadRecord& load) { load.name[40] = 'a'; });
  check_load(VerifyRule::out_of_range, "name", 3, [](LoadRecord& load) { std::memset(load.name, 'a', 48); });
  check_load(VerifyRule::inconsistent, "name", 4, [](LoadRecord& load) { load.name[9] = '0'; });
}

TEST_CASE("verify refuses: columns that are not finite, cut or absent, and more loads than there may be") {
  ModelMutant mutant = valid();
  mutant.records<float>(SectionKind::load_columns, 1)[7] = std::numeric_limits<float>::quiet_NaN();
  check_refused(mutant, VerifyRule::not_finite, SectionKind::load_columns, 1, 0, "column", 7);
  mutant = valid();
  mutant.rebuild([](auto& sections) { sections.back().bytes.resize(sections.back().bytes.size() - 4); });
  check_refused(mutant, VerifyRule::section_size, SectionKind::load_columns, 2, 0, "bytes", 0);
  mutant = valid();
  const std::uint64_t last = mutant.table().size() - 1;
  mutant.rebuild([](auto& sections) { sections.pop_back(); });
  check_refused(mutant, VerifyRule::section_missing, SectionKind::load_columns, 2, 0, "section", last);
  mutant = valid();
  mutant.records<layout::Info>(SectionKind::info)->loads = 4;
  check_refused(mutant, VerifyRule::section_size, SectionKind::loads, 0, 0, "bytes", 0);
  mutant = valid();
  mutant.records<layout::Info>(SectionKind::info)->loads = 65;
  check_refused(mutant, VerifyRule::out_of_range, SectionKind::info, 0, 0, "loads", 0);
}

TEST_CASE("verify refuses: two of three accelerations, loads of a scalar model and of a minor version without them") {
  ModelMutant two(SyntheticOptions{.levels = 1, .pressures = 2});
  auto* records = two.records<LoadRecord>(SectionKind::loads);
  for (std::uint32_t i = 0; i < 2; ++i) {
    records[i].kind = i + 1;
    std::memset(records[i].name, 0, sizeof(records[i].name));
  }
  check_refused(two, VerifyRule::inconsistent, SectionKind::loads, 0, 0, "kind", 0);
  ModelMutant scalar(SyntheticOptions{.components = 1, .levels = 1});
  scalar.header().minor = 6;
  scalar.records<layout::Info>(SectionKind::info)->loads = 1;
  check_refused(scalar, VerifyRule::out_of_range, SectionKind::info, 0, 0, "loads", 0);
  ModelMutant old = valid();
  old.header().minor = 5;
  check_refused(old, VerifyRule::bad_enum, SectionKind::loads, 0, 0, "section.kind", old.place(SectionKind::loads));
}

TEST_CASE("a model that is cut keeps the coefficients of its levels; ready and plain again it keeps its loads") {
  const auto file = encode(loaded_model());
  ModelMutant whole(file), cut(truncate_to_level(file, 1));
  REQUIRE(whole.verdict().ok());
  REQUIRE(cut.verdict().ok());
  CHECK(cut.view().loads.size() == loads);
  for (std::uint32_t q = 0; q < 2; ++q) {
    const std::size_t numbers = std::size_t{3} * loads * cut.view().level[q].counts->domain_count;
    CHECK(std::equal(cut.view().level[q].load_columns, cut.view().level[q].load_columns + numbers,
                     whole.view().level[q].load_columns));
  }
  ModelMutant ready(ready_file(file, std::vector<std::uint8_t>(whole.view().domain_count, 1)));
  REQUIRE(ready.verdict().ok());
  CHECK(ready.header().minor == 6);
  CHECK(ready.view().has_gravity());
  CHECK(plain_file(ready.bytes()) == file);
}

}  // namespace
}  // namespace greenloop
