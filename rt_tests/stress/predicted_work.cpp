#include "rt_tests/stress/predicted_work.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <istream>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/harness/contact_script.hpp"
#include "rt_tests/harness/loaded_driver.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/touchable_nodes.hpp"

extern char** environ;

namespace greenloop {
namespace {

std::vector<Constraint> spread_contacts(const ModelView& view, std::size_t most) {
  const std::vector<std::uint32_t> touchable = touchable_nodes(view);
  std::vector<Constraint> contacts(std::min(most, touchable.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float depth = 1e-5F * static_cast<float>(1 + i % 7);
    contacts[i] = {touchable[i * touchable.size() / contacts.size()], {depth, -depth, depth / 2}};
  }
  return contacts;
}

template <Driver D>
ReportedStep reported(const typename D::Solver::StepReport& report, bool with_field) {
  return {answered(report.status) ? D::way(report, with_field) : std::string(), report.work};
}

// of this program, and that the C library clears and copies by vectors: Valgrind would count every byte that one
// instruction of a processor clears
std::vector<std::string> environment() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("GLIBC_TUNABLES=")) variables.emplace_back(*variable);
  }
  variables.emplace_back(
      "GLIBC_TUNABLES=glibc.cpu.x86_rep_stosb_threshold=1073741824:glibc.cpu.x86_rep_movsb_threshold=1073741824");
  return variables;
}

// as a program is given them
std::vector<char*> pointers(const std::vector<std::string>& words) {
  std::vector<char*> result;
  for (const std::string& word : words) result.push_back(const_cast<char*>(word.c_str()));
  result.push_back(nullptr);
  return result;
}

// runs a command with its output in a file; its exit status
int run(const std::vector<std::string>& command, const std::filesystem::path& output) {
  const std::vector<std::string> variables = environment();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, command[0].c_str(), &actions, nullptr, pointers(command).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(
        fmt::format("{} cannot be run: {}; instructions are counted by Valgrind, Debian's package "
                    "valgrind",
                    command[0], std::strerror(error)));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

// the sums of the dumps in a file of callgrind's
std::vector<std::uint64_t> sums_of_dumps(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::uint64_t> sums;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("totals: ")) sums.push_back(std::stoull(line.substr(8)));
  }
  return sums;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

template <Driver D>
std::vector<ReportedStep> run_plainly(const Model& model, const StressOptions& options) {
  Hosted<typename D::Solver> host(model, D::limits(options.contacts, options.factors, options.prices));
  std::vector<ReportedStep> steps;
  visit_scripts(options, [&](ScriptKind kind, std::uint64_t cycles) {
    ContactScript script = script_of<D>(model, host, kind, options.seed);
    host.renew();
    for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
      const ScriptedStep& scripted = script.next();
      const std::uint64_t budget = options.budget > 0 ? options.budget : scripted.budget;
      steps.push_back(reported<D>(host.step(scripted.contacts, budget, scripted.with_field), scripted.with_field));
    }
  });
  host.renew();
  steps.push_back(reported<D>(host.step(spread_contacts(model.view(), options.contacts)), true));
  return steps;
}

template std::vector<ReportedStep> run_plainly<ElastostaticDriver>(const Model&, const StressOptions&);
template std::vector<ReportedStep> run_plainly<LoadedDriver>(const Model&, const StressOptions&);

void write_steps(const std::vector<ReportedStep>& steps, std::ostream& out) {
  for (const ReportedStep& step : steps) out << step.work << ' ' << step.way << '\n';
}

std::vector<ReportedStep> read_steps(std::istream& in) {
  std::vector<ReportedStep> steps;
  for (ReportedStep step; in >> step.work && in.get() == ' ' && std::getline(in, step.way);) steps.push_back(step);
  return steps;
}

std::vector<std::uint64_t> count_step_instructions(const std::string& solver, const std::vector<std::string>& command,
                                                   std::string& out) {
  const TemporaryFolder folder("greenloop_stress");
  const std::filesystem::path counts = folder.path() / "counts", output = folder.path() / "output";
  // callgrind takes an option only for a name that no other option has
  std::vector<std::string> all = {"valgrind",
                                  "--tool=callgrind",
                                  "--quiet",
                                  "--collect-atstart=no",
                                  "--toggle-collect=greenloop::" + solver + "::step*",
                                  "--dump-before=*" + solver + "::step*",
                                  "--dump-line=no",
                                  "--combine-dumps=yes",
                                  "--callgrind-out-file=" + counts.string()};
  all.insert(all.end(), command.begin(), command.end());
  const int status = run(all, output);
  if (status != 0) throw std::runtime_error(fmt::format("{}: ended with status {}", fmt::join(all, " "), status));
  out = text_of(output);
  std::vector<std::uint64_t> instructions = sums_of_dumps(counts);
  if (!instructions.empty()) instructions.erase(instructions.begin());  // of what is before the first step
  return instructions;
}

RatioQuantiles quantiles(std::vector<double> ratios) {
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1) + 0.5)];
  };
  const auto within =
      std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio >= 0.8 && ratio <= 1.25; });
  return {.steps = ratios.size(),
          .least = ratios.front(),
          .p05 = at(0.05),
          .median = at(0.5),
          .p95 = at(0.95),
          .most = ratios.back(),
          .within = static_cast<double>(within) / static_cast<double>(ratios.size())};
}

nlohmann::json as_json(const RatioQuantiles& ratios) {
  return {{"steps", ratios.steps}, {"least", ratios.least}, {"p05", ratios.p05},      {"median", ratios.median},
          {"p95", ratios.p95},     {"most", ratios.most},   {"within", ratios.within}};
}

nlohmann::json as_json(const PredictedWork& predicted) {
  nlohmann::json all = as_json(predicted.all);
  all["ways"] = nlohmann::json::object();
  for (const auto& [way, ratios] : predicted.ways) {
    all["ways"][way] = as_json(ratios);
  }
  return all;
}

void print_ratios(const std::map<std::string, RatioQuantiles>& ways, const RatioQuantiles& all) {
  fmt::print("{:<34} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8}\n", "answered by a factor", "steps", "least", "p05",
             "median", "p95", "most", "0.8-1.25");
  const auto print_row = [](const std::string& way, const RatioQuantiles& r) {
    fmt::print("{:<34} {:>7} {:>7.3g} {:>7.3g} {:>7.3g} {:>7.3g} {:>7.3g} {:>7.2f}%\n", way, r.steps, r.least, r.p05,
               r.median, r.p95, r.most, 100 * r.within);
  };
  for (const auto& [way, ratios] : ways) print_row(way, ratios);
  print_row("all", all);
}

PredictedWork compare(const std::vector<ReportedStep>& steps, const std::vector<std::uint64_t>& instructions) {
  if (steps.size() != instructions.size() || steps.empty()) {
    throw std::invalid_argument(
        fmt::format("{} steps were reported and {} were counted", steps.size(), instructions.size()));
  }
  std::map<std::string, std::vector<double>> ratios;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i].way.empty()) continue;
    ratios[steps[i].way].push_back(static_cast<double>(steps[i].work) / static_cast<double>(instructions[i]));
  }
  PredictedWork compared;
  std::vector<double> all;
  for (const auto& [way, of_way] : ratios) {
    all.insert(all.end(), of_way.begin(), of_way.end());
    compared.ways[way] = quantiles(of_way);
  }
  compared.all = quantiles(std::move(all));
  compared.heaviest_instructions = instructions.back();
  return compared;
}

}  // namespace greenloop
