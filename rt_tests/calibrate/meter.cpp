#include "rt_tests/calibrate/meter.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/harness/prices_file.hpp"
#include "rt_tests/stress/predicted_work.hpp"

namespace greenloop {

Meter time_meter(int repetitions, const Stopwatch& stopwatch) {
  constexpr double clock_can_tell = 100;
  const auto costs = [=](const NamedModel& model, const ScriptOptions& options, const Prices& prices,
                         const std::vector<BodySteps>& bodies, const Progress& progress) {
    std::vector<double> least;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      progress(static_cast<double>(repetition) / repetitions);
      const std::vector<RanStep> ran = run_steps(model.model, options, prices, bodies, stopwatch);
      least.resize(ran.size(), std::numeric_limits<double>::infinity());
      for (std::size_t i = 0; i < ran.size(); ++i) least[i] = std::min(least[i], ran[i].ns);
    }
    return least;
  };
  return {"ns", clock_can_tell, true, costs};
}

Meter instruction_meter(const std::string& program) {
  const auto costs = [=](const NamedModel& model, const ScriptOptions& options, const Prices& prices,
                         const std::vector<BodySteps>&, const Progress&) {
    const TemporaryFolder folder("greenloop_calibrate");
    const std::string file = folder.write("prices.json", prices_as_json(prices, "")).string();
    std::string out;
    const std::vector<std::uint64_t> instructions = count_step_instructions(
        "Elastostatic",
        {program, model.name, "--run-steps", "--contacts", std::to_string(options.contacts), "--cycles",
         std::to_string(options.cycles), "--seed", std::to_string(options.seed), "--prices", file},
        out);
    return std::vector<double>(instructions.begin(), instructions.end());
  };
  return {"instructions", 1, false, costs};
}

}  // namespace greenloop
