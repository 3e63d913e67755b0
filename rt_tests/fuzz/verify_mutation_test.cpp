// The fuzz target's function on random changes of valid files: what continuous integration runs of it.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <utility>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/ready_file.hpp"
#include "rt_tests/fuzz/walk_view.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t seed = 20260722;
constexpr int mutations = 200'000;

constexpr std::array<std::uint32_t, 12> telling = {0,          1,          2,          0x7f,       0x80,       0xff,
                                                   0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000, 0x10000};

class Mutator {
 public:
  explicit Mutator(std::vector<std::vector<std::byte>> seeds) : seeds_(std::move(seeds)) {}

  std::vector<std::byte> next() {
    std::vector<std::byte> file = seeds_[below(seeds_.size())];
    for (std::size_t change = below(3) + 1; change > 0; --change) mutate(file);
    return file;
  }

 private:
  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(random_() % limit); }

  // half of the changes meet the header and the table, which are a small part of the file
  std::size_t place(const std::vector<std::byte>& file) {
    return below(2) == 0 ? below(std::min<std::size_t>(file.size(), 1024)) : below(file.size());
  }

  void mutate(std::vector<std::byte>& file) {
    const std::size_t at = place(file), word = at / 4 * 4;
    switch (below(8)) {
      case 0:
      case 1:
        file[at] ^= std::byte{1} << below(8);
        break;
      case 2:
        file[at] = static_cast<std::byte>(below(256));
        break;
      case 3:
      case 4:
        std::memcpy(file.data() + word, &telling[below(telling.size())], 4);
        break;
      case 5:
        std::swap_ranges(file.begin() + word, file.begin() + word + 4, file.begin() + place(file) / 4 * 4);
        break;
      case 6:
        std::memmove(file.data() + word, file.data() + place(file) / 4 * 4, 4);
        break;
      default:
        if (below(8) == 0) file.resize(std::max<std::size_t>(64, at / 64 * 64));
        break;
    }
  }

  std::vector<std::vector<std::byte>> seeds_;
  std::mt19937_64 random_{seed};
};

std::vector<std::byte> measured_model() {
  ModelData model = synthetic_model({.levels = 2});
  for (LevelData& level : model.levels) level.patterns = synthetic_patterns();
  return encode(model);
}

void check_survival(Mutator mutator) {
  MESSAGE("seed ", seed, ", ", mutations, " mutations");
  int accepted = 0;
  std::array<int, 64> refused{};
  for (int i = 0; i < mutations; ++i) {
    const InputOutcome outcome = try_input(mutator.next());
    accepted += outcome.accepted ? 1 : 0;
    ++refused.at(static_cast<std::size_t>(outcome.rule));
  }
  CHECK(accepted > mutations / 100);
  CHECK(accepted < mutations / 2);

  // every rule was met but those that the mending of length and checksums puts right or no change of a word can break
  for (const VerifyRule rule : {VerifyRule::bad_magic, VerifyRule::foreign_endianness, VerifyRule::unsupported_major,
                                VerifyRule::section_out_of_bounds, VerifyRule::section_misaligned,
                                VerifyRule::section_overlap, VerifyRule::section_missing, VerifyRule::section_size,
                                VerifyRule::padding_not_zero, VerifyRule::reserved_not_zero, VerifyRule::bad_enum,
                                VerifyRule::out_of_range, VerifyRule::not_finite, VerifyRule::not_increasing,
                                VerifyRule::inconsistent, VerifyRule::section_order, VerifyRule::section_duplicate}) {
    CAPTURE(rule_name(rule));
    CHECK(refused[static_cast<std::size_t>(rule)] > 0);
  }
}

TEST_CASE("verify survives random changes of valid files, and what it accepts is sound") {
  check_survival(Mutator(
      {encode(synthetic_model({.levels = 1})), encode(synthetic_model({.levels = 2})),
       encode(synthetic_model({.levels = 3, .epsilon = 0.008})),
       encode(synthetic_model({.levels = 2, .coarsest_constraint_level = 1, .wavelet = layout::Wavelet::linear})),
       encode(synthetic_model({.levels = 2, .wavelet = layout::Wavelet::lifted_butterfly})), measured_model(),
       encode(synthetic_model({.levels = 2, .vertices = 40})),
       encode(synthetic_model({.levels = 2, .gravity = true, .pressures = 2}))}));
}

// everything is read
std::vector<std::byte> made_ready(const SyntheticOptions& options) {
  ModelMutant plain(options);
  REQUIRE(plain.verdict().ok());
  return ready_file(plain.bytes(), std::vector<std::uint8_t>(plain.view().domain_count, 1));
}

TEST_CASE("verify survives random changes of ready files, and what it accepts is sound") {
  check_survival(Mutator({made_ready({.levels = 1}), made_ready({.levels = 3, .vertices = 4}),
                          made_ready({.components = 1, .levels = 2, .wavelet = layout::Wavelet::butterfly})}));
}

TEST_CASE("verify survives random changes of scalar models, and what it accepts is sound") {
  check_survival(Mutator({encode(smallest_scalar_model()), encode(synthetic_model({.components = 1, .levels = 2})),
                          encode(synthetic_model({.components = 1, .levels = 3, .epsilon = 0.008})),
                          encode(synthetic_model({.components = 1,
                                                  .levels = 2,
                                                  .coarsest_constraint_level = 1,
                                                  .wavelet = layout::Wavelet::equilibrated,
                                                  .vertices = 40}))}));
}

TEST_CASE("verify survives random changes of impulse response models, and what it accepts is sound") {
  // an elastostatic one too, since nothing has to increase in the others
  check_survival(Mutator(
      {encode(synthetic_model({.levels = 2})), encode(synthetic_motion({.vertices = 20, .orbits = 4, .rows = 6})),
       encode(synthetic_motion({.vertices = 40, .planes = 2, .orbits = 4, .rows = 5, .alternating = true})),
       encode(synthetic_motion({.vertices = 20, .orbits = 4, .rows = 6, .transfer_modes = 2}))}));
}

TEST_CASE("verify survives random changes of multigrid models, and what it accepts is sound") {
  check_survival(Mutator({encode(synthetic_model({.levels = 2})), encode(synthetic_multigrid({})),
                          encode(synthetic_multigrid({.cells = 3, .grids = 1})),
                          encode(synthetic_multigrid({.cells = 1, .grids = 2, .strain = layout::Strain::green}))}));
}

TEST_CASE("walk_view sees rows and parents of multigrid models that verify must prevent") {
  ModelMutant mutant(encode(synthetic_multigrid({})));
  REQUIRE(mutant.verdict().ok());
  const ModelView view = mutant.view();
  const auto seen = [&](auto& number, auto wrong) {
    const auto right = number;
    number = static_cast<std::remove_reference_t<decltype(number)>>(wrong);
    const bool found = !walk_view(mutant.bytes(), view);
    number = right;
    return found && walk_view(mutant.bytes(), view);
  };
  CHECK(seen(mutant.records<layout::TetrahedronRecord>(layout::SectionKind::tetrahedra)[3].vertex[2], 12));
  CHECK(seen(mutant.records<std::uint32_t>(layout::SectionKind::columns)[3], 8));
  CHECK(seen(mutant.records<std::uint32_t>(layout::SectionKind::row_starts)[3], 99));
  CHECK(seen(mutant.records<std::uint32_t>(layout::SectionKind::parents, 1)[1], 2));
  CHECK(seen(mutant.records<float>(layout::SectionKind::inverses)[0], std::numeric_limits<float>::infinity()));
}

TEST_CASE("walk_view sees orbits and references of impulse responses that verify must prevent") {
  ModelMutant mutant(encode(synthetic_motion({.transfer_modes = 3})));
  REQUIRE(mutant.verdict().ok());
  const ModelView view = mutant.view();
  const auto seen = [&](auto& number, auto wrong) {
    const auto right = number;
    number = static_cast<std::remove_reference_t<decltype(number)>>(wrong);
    const bool found = !walk_view(mutant.bytes(), view);
    number = right;
    return found && walk_view(mutant.bytes(), view);
  };
  CHECK(seen(mutant.records<layout::OrbitRecord>(layout::SectionKind::orbits)[3].rows, 100'000));
  CHECK(seen(mutant.records<layout::OrbitRecord>(layout::SectionKind::orbits)[1].next_orbit, 10));
  CHECK(seen(mutant.records<layout::ReferenceRecord>(layout::SectionKind::references)[5].orbit, 10));
  CHECK(seen(mutant.records<std::uint32_t>(layout::SectionKind::triangles)[7], 100));
  CHECK(seen(mutant.records<float>(layout::SectionKind::shape)[7], std::numeric_limits<float>::infinity()));
  CHECK(seen(mutant.records<std::int16_t>(layout::SectionKind::coordinates)[7], -32768));
  CHECK(seen(mutant.records<std::int16_t>(layout::SectionKind::transfer_coordinates)[7], -32768));
  CHECK(seen(mutant.records<float>(layout::SectionKind::transfer_quanta)[7], std::numeric_limits<float>::infinity()));
}

TEST_CASE("walk_view sees scalar blocks and scales that verify must prevent") {
  ModelMutant mutant(SyntheticOptions{.components = 1, .levels = 3});
  REQUIRE(mutant.verdict().ok());
  const ModelView view = mutant.view();
  CHECK(walk_view(mutant.bytes(), view));
  float& scale = mutant.records<float>(layout::SectionKind::scales, 2)[7];
  const float right_scale = std::exchange(scale, -1.0F);
  CHECK_FALSE(walk_view(mutant.bytes(), view));
  scale = right_scale;
  for (const std::uint32_t layer : {2u, 3u}) {
    const auto& header = *mutant.records<layout::CouplingsHeader>(layout::SectionKind::couplings, 2, layer);
    REQUIRE(header.block_count > 0);
    auto* value = mutant.records<std::uint8_t>(layout::SectionKind::couplings, 2, layer, header.value_offset);
    std::uint8_t& last = value[header.block_count - 1];
    const std::uint8_t right = std::exchange(last, std::uint8_t{0x80});
    CHECK_FALSE(walk_view(mutant.bytes(), view));
    last = right;
  }
  CHECK(walk_view(mutant.bytes(), view));
  ModelView other = view;
  other.problem = layout::Problem::elastostatic;
  CHECK_FALSE(walk_view(mutant.bytes(), other));
}

TEST_CASE("walk_view sees stencils that verify must prevent") {
  ModelMutant mutant(SyntheticOptions{.levels = 2, .wavelet = layout::Wavelet::butterfly});
  REQUIRE(mutant.verdict().ok());
  CHECK(walk_view(mutant.bytes(), mutant.view()));
  auto* stencils = mutant.records<layout::StencilRecord>(layout::SectionKind::stencils, 1);
  const std::uint32_t wing = std::exchange(stencils[0].wing[1], 6);
  CHECK_FALSE(walk_view(mutant.bytes(), mutant.view()));
  stencils[0].wing[1] = layout::none;
  CHECK_FALSE(walk_view(mutant.bytes(), mutant.view()));
  stencils[0].wing[1] = wing;
  CHECK(walk_view(mutant.bytes(), mutant.view()));
}

TEST_CASE("walk_view sees patterns that verify must prevent") {
  ModelMutant mutant(measured_model());
  REQUIRE(mutant.verdict().ok());
  CHECK(walk_view(mutant.bytes(), mutant.view()));
  auto* patterns = mutant.records<layout::PatternRecord>(layout::SectionKind::patterns, 1);
  const std::uint32_t kind = std::exchange(patterns[1].kind, layout::pattern_kinds + 1);
  CHECK_FALSE(walk_view(mutant.bytes(), mutant.view()));
  patterns[1].kind = kind;
  CHECK(walk_view(mutant.bytes(), mutant.view()));
}

TEST_CASE("walk_view sees what verify must prevent") {
  ModelMutant mutant(SyntheticOptions{.levels = 2});
  REQUIRE(mutant.verdict().ok());
  const ModelView view = mutant.view();
  CHECK(walk_view(mutant.bytes(), view));

  CHECK_FALSE(walk_view(mutant.bytes().first(mutant.bytes().size() - 64), view));
  auto* parents = mutant.records<layout::RefinementRecord>(layout::SectionKind::refinement, 1);
  parents[0].parent[1] += 6;
  CHECK_FALSE(walk_view(mutant.bytes(), view));
  parents[0].parent[1] -= 6;
  auto& info = *mutant.records<layout::Info>(layout::SectionKind::info);
  const float quantum = std::exchange(info.quantum[3], 2.0F);
  CHECK_FALSE(walk_view(mutant.bytes(), view));
  info.quantum[3] = quantum;
  const auto& couplings = *mutant.records<layout::CouplingsHeader>(layout::SectionKind::couplings, 1, 2);
  auto* index = mutant.records<std::uint16_t>(layout::SectionKind::couplings, 1, 2, couplings.index_offset);
  const std::uint16_t row = std::exchange(index[0], static_cast<std::uint16_t>(couplings.rows));
  CHECK_FALSE(walk_view(mutant.bytes(), view));
  index[0] = row;
  for (const std::uint32_t layer : {2u, 3u}) {
    const auto& header = *mutant.records<layout::CouplingsHeader>(layout::SectionKind::couplings, 1, layer);
    REQUIRE(header.block_count > 0);
    auto* value = mutant.records<std::uint8_t>(layout::SectionKind::couplings, 1, layer, header.value_offset);
    const std::uint8_t right = std::exchange(value[3], std::uint8_t{0x80});
    CHECK_FALSE(walk_view(mutant.bytes(), view));
    value[3] = right;
  }
  CHECK(walk_view(mutant.bytes(), view));
}

}  // namespace
}  // namespace greenloop
