#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rt_tests/harness/contact_script.hpp"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/harness/recorded_script.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// The steps of a body from its creation on.
using BodySteps = std::vector<ScriptedStep>;

/// Steps to be calibrated with.
struct ScriptOptions {
  std::uint32_t contacts = 64;  ///< most of a step
  std::uint32_t factors = 8;    ///< sets of contacts that the body remembers
  std::uint64_t cycles = 3000;  ///< steps, shared among the bodies
  std::uint64_t seed = 1;       ///< of the first body; each has two more than the one before
};

/// All kinds of scripts but `garbage` one after the other on each of six bodies, kept so that they can be run again:
/// the same contacts, and budgets of bodies whose work has these prices. Two bodies have the scripts' budgets, the
/// others a quarter, 1/16, 1/64 and 1/256 of the declared worst work, or the least that is admitted. Throws
/// std::runtime_error if there is no such body, or no node is touchable.
[[nodiscard]] std::vector<BodySteps> record_steps(const Model& model, const ScriptOptions& options,
                                                  const Prices& prices);

/// Of a body that RecordedScript is for.
constexpr ScriptOptions recorded_options() {
  return {.contacts = RecordedScript::most_contacts, .factors = RecordedScript::sets, .cycles = RecordedScript::cycles};
}

/// RecordedScript on one body: what a target runs that counts its own steps. Throws std::runtime_error if there is no
/// such body, or no node is touchable.
[[nodiscard]] std::vector<BodySteps> record_script(const Model& model, const Prices& prices);

/// Runs `work`, and returns the nanoseconds that it took.
using Stopwatch = std::function<double(const std::function<void()>& work)>;

/// A step that was run.
struct RanStep {
  std::string way;  ///< ElastostaticDriver::way; empty: refused
  std::uint64_t work = 0;
  double ns = 0;
};

/// Runs them on new bodies with these prices, each step under the stopwatch. Throws std::runtime_error as record_steps.
[[nodiscard]] std::vector<RanStep> run_steps(const Model& model, const ScriptOptions& options, const Prices& prices,
                                             const std::vector<BodySteps>& bodies, const Stopwatch& stopwatch);

/// The same, where nobody asks how long they take: `ns` is 0.
[[nodiscard]] std::vector<RanStep> run_steps(const Model& model, const ScriptOptions& options, const Prices& prices,
                                             const std::vector<BodySteps>& bodies);

/// Processor time of this thread, less what reading it takes.
[[nodiscard]] Stopwatch thread_stopwatch();

}  // namespace greenloop
