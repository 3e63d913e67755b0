#include "rt_tests/harness/recorded_run.hpp"

#include <array>
#include <bit>

#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/harness/recorded_script.hpp"
#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {
namespace {

template <Driver D>
void run_script(RecordedScript& script, typename D::Solver& body, std::span<float> field, bool flip, RecordedRun& run) {
  Fnv1a digest;
  typename D::Solver::StepReport last;
  std::array<float, 3 * (RecordedScript::most_contacts + 1)> force_memory{};
  for (std::uint32_t i = 0; i < RecordedScript::cycles; ++i) {
    const RecordedScript::Cycle cycle = script.next();
    const std::span<float> force(force_memory.data(), 3 * cycle.contacts.size());
    const auto report = body.step(cycle.contacts, cycle.budget,
                                  {as_vec3(force), as_vec4(cycle.with_field ? field : std::span<float>())});
    if (flip && i == RecordedScript::cycles / 2) {
      field[0] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(field[0]) ^ 1U);
    }
    D::count(report, last, run.counts);
    last = report;
    for (const std::uint64_t fact : D::all_facts(report)) {
      digest.add_word(fact);
    }
    digest.add_words(force);
    digest.add_words(field);
  }
  run.digest = digest.value();
}

}  // namespace

bool RecordedRun::complete(std::uint32_t model_levels) const noexcept {
  for (std::uint32_t level = 0; level < model_levels; ++level) {
    if (counts.by_level[level] == 0) {
      return false;
    }
  }
  return counts.of(Status::ok) > 1000 && counts.of(Status::coarser) > 1000 && counts.of(Status::held_not_finite) > 0 &&
         counts.of(Status::held_out_of_range) > 0 && counts.of(Status::held_not_touchable) > 0 &&
         counts.of(Status::held_duplicate) > 0 && counts.of(Status::held_over_budget) > 0 &&
         counts.of(Status::held_overflow) > 0 && counts.cached > 1000 && counts.refined > 10;
}

template <Driver D>
RecordedRun run_recorded_script(std::span<const std::byte> bytes, std::span<std::byte> arena, std::span<float> field,
                                bool flip) noexcept {
  RecordedRun run;
  const auto opened = Model::open(bytes);
  if (!opened) {
    run.error = opened.result.field;
    return run;
  }
  constexpr auto limits = D::limits(RecordedScript::most_contacts, RecordedScript::sets);
  const auto need = D::Solver::required(opened.model, limits);
  run.arena_bytes = need.bytes;
  auto created = D::Solver::create(opened.model, limits, arena);
  RecordedScript script(opened.model, D::bounds(limits, need));
  const std::size_t floats = std::size_t{4} * opened.model.node_count();
  if (!created || !script.usable() || field.size() < floats) {
    run.error = "too large a model for the memory given";
    return run;
  }
  run_script<D>(script, created.body, field.first(floats), flip, run);
  if (!run.complete(opened.model.level_count())) {
    run.error = "the script did not meet all it is meant to meet";
  }
  return run;
}

template RecordedRun run_recorded_script<ElastostaticDriver>(std::span<const std::byte>, std::span<std::byte>,
                                                             std::span<float>, bool) noexcept;

}  // namespace greenloop
