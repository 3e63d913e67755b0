// greenloop-stress: random and adversarial contacts on a model, every step checked against what the runtime declares.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>

#include "formats/describe.hpp"
#include "formats/model_file.hpp"
#include "rt_tests/stress/heaviest_step.hpp"
#include "rt_tests/stress/stress_run.hpp"

namespace {

using greenloop::InjectedFault;
using greenloop::StressResult;
using greenloop::TimeHistogram;

nlohmann::json to_json(const StressResult& result, std::int64_t instructions) {
  nlohmann::json system_calls = nullptr;
  if (result.system_calls >= 0) {
    system_calls = result.system_calls;
  }
  nlohmann::json instructions_max = nullptr;
  if (instructions >= 0) {
    instructions_max = instructions;
  }
  return {{"cycles", result.cycles},
          {"answered", result.answered},
          {"refused", result.refused},
          {"wrong_answers", result.wrong_answers},
          {"work_overruns", result.work_overruns},
          {"allocations", result.allocations},
          {"locks", result.locks},
          {"syscalls", system_calls},
          {"minor_faults", result.minor_faults},
          {"worst_work", result.worst_work},
          {"declared_work", result.declared_work},
          {"instructions_max", instructions_max},
          {"force_step_max", result.force_step_max},
          {"digest", result.digest}};
}

void print_times(const TimeHistogram& times, std::uint64_t cycles) {
  std::printf(
      "execution, thread CPU time: min %.1f us, mean %.1f us, max %.1f us (the clock itself costs up to 1.5 us)\n",
      times.least, times.total / static_cast<double>(cycles), times.most);
  std::uint64_t most = 1;
  for (const std::uint64_t count : times.count) {
    most = std::max(most, count);
  }
  for (std::size_t bin = 0; bin < TimeHistogram::bins; ++bin) {
    if (times.count[bin] > 0) {
      const auto length = static_cast<int>((50 * times.count[bin] + most - 1) / most);
      std::printf("%6zu us %9llu %.*s\n", bin, static_cast<unsigned long long>(times.count[bin]), length,
                  "##################################################");
    }
  }
  std::printf("%5zu+ us %9llu\n", TimeHistogram::bins, static_cast<unsigned long long>(times.overflow));
}

void print(const StressResult& result, std::int64_t instructions) {
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("%llu cycles: %llu answered (%llu coarser, %llu with a cached factor), %llu refused\nlevels used:",
              number(result.cycles), number(result.answered), number(result.coarser), number(result.cached),
              number(result.refused));
  for (std::uint32_t c = 0; c < greenloop::layout::max_levels; ++c) {
    if (result.levels[c] > 0) {
      std::printf("  %u: %llu", c, number(result.levels[c]));
    }
  }
  std::printf("\nworst work %llu of %llu declared units\n", number(result.worst_work), number(result.declared_work));
  std::printf("work overruns %llu, wrong answers %llu, allocations %llu, locks %llu, minor faults %llu, ",
              number(result.work_overruns), number(result.wrong_answers), number(result.allocations),
              number(result.locks), number(result.minor_faults));
  if (result.system_calls < 0) {
    std::printf("system calls not watched (this kernel has no Syscall User Dispatch)\n");
  } else {
    std::printf("system calls %lld\n", static_cast<long long>(result.system_calls));
  }
  if (instructions < 0) {
    std::printf("instructions not counted\n");
  } else {
    std::printf("instructions of the heaviest kind of step %lld\n", static_cast<long long>(instructions));
  }
  std::printf("largest step of the total force while pressing %.3g N\ndigest %016llx\n", result.force_step_max,
              number(result.digest));
  print_times(result.times, result.cycles);
  std::printf("%s\n", result.passed() ? "PASS" : "FAIL");
}

int stress(int argc, char** argv) {
  CLI::App app("Random and adversarial contacts on a model; every step is checked against its declared work.");
  std::string path;
  greenloop::StressOptions options;
  bool json = false;
  bool count_instructions = true;
  options.limits.max_contacts = 0;
  app.add_option("MODEL", path, "model file (.gloop)")->required()->check(CLI::ExistingFile);
  app.add_option("--cycles", options.cycles, "steps to run")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the script")->capture_default_str();
  app.add_option("--contacts", options.limits.max_contacts, "most contacts of a step; else what the model asks for")
      ->check(CLI::Range(1, 4096));
  app.add_option("--factors", options.limits.cached_factors, "cached factors")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_flag("--instructions,!--no-instructions", count_instructions,
               "count those of the heaviest kind of step; microseconds each");
  app.add_flag("--json", json, "machine-readable result");
  const std::map<std::string, InjectedFault> faults = {{"allocation", InjectedFault::allocation},
                                                       {"lock", InjectedFault::lock},
                                                       {"system-call", InjectedFault::system_call},
                                                       {"overrun", InjectedFault::overrun}};
  app.add_option("--inject", options.fault, "a fault in every hundredth step, to see the verdict fail")
      ->transform(CLI::CheckedTransformer(faults, CLI::ignore_case));
  CLI11_PARSE(app, argc, argv);

  const greenloop::AlignedBytes bytes = greenloop::load_file(path);
  const auto opened = greenloop::Model::open(bytes.span());
  if (!opened) {
    throw std::runtime_error(path + ": " + greenloop::describe(opened.result));
  }
  if (options.limits.max_contacts == 0) {
    options.limits.max_contacts = opened.model.view().info->max_contacts;
  }
  const StressResult result = greenloop::run_stress(opened.model, options);
  const std::int64_t instructions =
      count_instructions ? greenloop::instructions_of_heaviest_step(opened.model, options.limits) : -1;
  if (json) {
    std::printf("%s\n", to_json(result, instructions).dump(2).c_str());
  } else {
    print(result, instructions);
  }
  return result.passed() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "greenloop-stress: %s\n", error.what());
    return 2;
  }
}
