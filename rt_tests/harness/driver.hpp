#pragma once

#include <concepts>
#include <cstdint>
#include <string>

#include "rt_tests/harness/answer_counts.hpp"
#include "rt_tests/harness/script_bounds.hpp"
#include "runtime/prices.hpp"

namespace greenloop {

/// What the tools need of a solver beyond the verbs of runtime/loop.hpp, `required`, `create` and `step`: the stress
/// run, the recorded script and the firmware are written against it. Another solver is another driver.
template <class D>
concept Driver = requires(std::uint32_t count, const Prices& prices, const typename D::Solver::Limits& limits,
                          const typename D::Solver::Requirement& requirement,
                          const typename D::Solver::StepReport& report, AnswerCounts& counts) {
  // of a body that takes so many contacts, remembers so many sets of them and has these prices
  { D::limits(count, count, prices) } -> std::same_as<typename D::Solver::Limits>;
  { D::bounds(limits, requirement) } -> std::same_as<ScriptBounds>;
  // the most units that an answered step may have taken that reports this
  { D::declared_work(requirement, report) } -> std::same_as<std::uint64_t>;
  // adds a step to the counts; the second report is of the step before
  D::count(report, report, counts);
  // in words how an answered step was answered, with a field or not
  { D::way(report, bool{}) } -> std::convertible_to<std::string>;
  // words that say what was answered, and all that is known of how
  D::facts(report);
  D::all_facts(report);
};

}  // namespace greenloop
