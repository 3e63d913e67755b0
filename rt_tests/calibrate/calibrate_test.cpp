#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/calibrate/calibration.hpp"
#include "rt_tests/calibrate/counted_steps.hpp"
#include "rt_tests/calibrate/price_fit.hpp"
#include "rt_tests/harness/price_table.hpp"
#include "rt_tests/harness/prices_file.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/hosted/thread_clock.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

const auto no_progress = [](double) {};

Eigen::Index place(const std::string& name) {
  const auto row = std::find_if(std::begin(price_rows), std::end(price_rows),
                                [&](const PriceRow& candidate) { return name == candidate.name; });
  REQUIRE(row != std::end(price_rows));
  return row - std::begin(price_rows);
}

// steps and the counts of those that are kept
struct Counted {
  std::vector<ScriptedStep> scripted;
  CountedSteps steps;

  Counted(const Model& model, const ScriptOptions& options) {
    const std::vector<BodySteps> bodies = record_steps(model, options, counting_prices());
    for (const BodySteps& body : bodies) scripted.insert(scripted.end(), body.begin(), body.end());
    steps = count_steps(model, options, bodies, no_progress);
  }
};

TEST_CASE("counts are those of the formulas") {
  const TestModel model({.levels = 3});
  const Counted counted(model.model(), {.contacts = 12, .factors = 3, .cycles = 2400});
  const CountedSteps& steps = counted.steps;
  const Eigen::Index eliminated = place("eliminated"), node = place("node"), checked = place("checked_contact");
  int fresh = 0, fields = 0;
  for (std::size_t i = 0; i < steps.step.size(); ++i) {
    const ScriptedStep& scripted = counted.scripted[steps.step[i]];
    const auto row = static_cast<Eigen::Index>(i);
    CAPTURE(steps.way[i]);
    CAPTURE(scripted.contacts.size());
    if (scripted.contacts.empty()) continue;
    CHECK(steps.counts(row, checked) == static_cast<double>(scripted.contacts.size()));
    CHECK(steps.counts(row, place("step")) == 1);
    if (scripted.budget < any_budget) continue;
    if (scripted.with_field) {
      CHECK(steps.counts(row, node) == model.view().node_count);
      ++fields;
    }
    const double n = padded_order(static_cast<std::uint32_t>(3 * scripted.contacts.size()));
    const bool is_fresh = steps.way[i] == "fresh" || steps.way[i] == "fresh, field";
    CHECK(steps.counts(row, eliminated) == (is_fresh ? n * (n + 4) * (n + 8) / 6 : 0));
    fresh += is_fresh ? 1 : 0;
  }
  CHECK(fresh > 50);
  CHECK(fields > 200);
  CHECK(steps.step.size() > counted.scripted.size() * 3 / 4);
}

// the default prices, each times another factor
Eigen::VectorXd other_prices() {
  Eigen::VectorXd units = in_units({});
  for (Eigen::Index j = 0; j < units.size(); ++j) {
    units[j] = (units[j] > 0 ? units[j] : 50) * (0.6 + 0.12 * static_cast<double>(j * 7 % 9));
  }
  return units;
}

TEST_CASE("a clock that charges a table gives that table's times back") {
  const TestModel model({.levels = 3});
  ScriptOptions options{.contacts = 12, .factors = 3, .cycles = 1600};
  const Eigen::VectorXd charged = other_prices();
  const std::vector<BodySteps> bodies = record_steps(model.model(), options, counting_prices());
  const CountedSteps counted = count_steps(model.model(), options, bodies, no_progress);
  // each reading of the clock is of the next step; every second run is disturbed
  std::vector<double> ns(static_cast<std::size_t>(options.cycles), 1e9);
  for (std::size_t i = 0; i < counted.step.size(); ++i) {
    ns[counted.step[i]] = counted.counts.row(static_cast<Eigen::Index>(i)).dot(charged);
  }
  std::size_t reading = 0;
  const Stopwatch clock = [&](const std::function<void()>& work) {
    work();
    const bool disturbed = reading / ns.size() % 2 == 0;
    return ns[reading++ % ns.size()] * (disturbed ? 3 : 1);
  };
  const std::vector<double> least =
      time_meter(4, clock).costs({"m.gloop", model.model()}, options, counting_prices(), bodies, no_progress);
  CHECK(reading == 4 * ns.size());
  FitSteps fit{counted.counts, Eigen::VectorXd(counted.counts.rows()), counted.way};
  for (std::size_t i = 0; i < counted.step.size(); ++i) fit.cost[static_cast<Eigen::Index>(i)] = least[counted.step[i]];
  const Eigen::VectorXd found = in_units(fit_prices(fit));

  options.seed = 2;
  const Counted others(model.model(), options);
  const Eigen::VectorXd expected = others.steps.counts * charged, predicted = others.steps.counts * found;
  CHECK(expected.size() > 1000);
  CHECK((predicted.cwiseQuotient(expected).array() - 1).abs().maxCoeff() < 0.02);
  CHECK((counted.counts * in_units({})).cwiseQuotient(fit.cost).maxCoeff() >
        1.3 * (counted.counts * in_units({})).cwiseQuotient(fit.cost).minCoeff());
}

TEST_CASE("prices that no step pays keep the ratio of the default ones") {
  const Eigen::Index slot = place("slot"), node = place("node"), touched = place("touched");
  FitSteps steps{Eigen::MatrixXd::Zero(40, static_cast<Eigen::Index>(price_count)), Eigen::VectorXd(40),
                 std::vector<std::string>(40, "all")};
  const Prices usual;
  for (Eigen::Index i = 0; i < 40; ++i) {
    steps.counts(i, slot) = static_cast<double>(100 + i);
    steps.counts(i, touched) = static_cast<double>(100 + i);  // always with it: their ratio is not told either
    steps.counts(i, node) = static_cast<double>(1000 + i * i);
    steps.cost[i] = steps.counts.row(i).dot(in_units(usual)) * 3;
  }
  const Prices found = fit_prices(steps);
  const auto ratio = [&](const char* name) {
    const Eigen::Index j = place(name);
    return in_units(found)[j] / in_units(usual)[j];
  };
  for (const char* name : {"slot", "node", "touched", "butterfly_node", "near_factor"}) {
    CAPTURE(name);
    CHECK(ratio(name) == doctest::Approx(3).epsilon(0.01));
  }
  CHECK_THROWS_AS(static_cast<void>(fit_prices({})), std::invalid_argument);
}

TEST_CASE("prices of another processor are fitted to what it counted in the recorded script") {
  const TestModel model({.levels = 3});
  const std::vector<NamedModel> models{{"m.gloop", model.model()}};
  const std::vector<BodySteps> bodies = record_script(model.model(), counting_prices());
  const CountedSteps counted = count_steps(model.model(), recorded_options(), bodies, no_progress);
  std::vector<double> costs(RecordedScript::cycles, 1);
  for (std::size_t i = 0; i < counted.step.size(); ++i) {
    costs[counted.step[i]] = counted.counts.row(static_cast<Eigen::Index>(i)).dot(other_prices());
  }
  const Calibration calibration = calibrate(models, {}, costs, "cycles");
  CHECK(calibration.unit == "cycles");
  CHECK(calibration.fitted > 2000);
  CHECK(calibration.all.steps > 2000);
  CHECK(calibration.all.least > 0.98);
  CHECK(calibration.all.most < 1.02);
  costs.pop_back();
  CHECK_THROWS_WITH_AS(static_cast<void>(calibrate(models, {}, costs, "cycles")),
                       "9999 costs for 10000 steps of 1 models", std::runtime_error);
}

TEST_CASE("the stopwatch tells processor time, without the time of its own") {
  const Stopwatch clock = thread_stopwatch();
  double least = 1e9;
  for (int i = 0; i < 200; ++i) least = std::min(least, clock([] {}));
  CHECK(least < 200);
  const double ns = clock([] {
    for (const std::int64_t begin = thread_nanoseconds(); thread_nanoseconds() < begin + 1000000;) {
    }
  });
  CHECK(ns > 0.95e6);
  CHECK(ns < 5e6);
}

TEST_CASE("too few steps are refused with what to do") {
  const TestModel model({.levels = 2});
  const std::vector<NamedModel> models{{"m.gloop", model.model()}};
  const Meter clock = time_meter(1, thread_stopwatch());
  CHECK_THROWS_WITH_AS(static_cast<void>(calibrate(models, {.contacts = 4, .cycles = 60}, clock)),
                       doctest::Contains("m.gloop: "), std::runtime_error);
  CHECK_THROWS_WITH_AS(static_cast<void>(calibrate(models, {.contacts = 4, .cycles = 60}, clock)),
                       doctest::Contains("give more --cycles"), std::runtime_error);
}

TEST_CASE("a file of prices is read back, with its unit") {
  const TemporaryFolder folder("greenloop_calibrate_prices");
  Prices prices;
  for (std::size_t j = 0; j < price_count; ++j) prices.*price_rows[j].member = static_cast<std::uint32_t>(77 * j + 1);
  const std::string path = folder.write("prices.json", prices_as_json(prices, "ns"));
  CHECK(nlohmann::json::parse(std::ifstream(path))["unit"] == "ns");
  const Prices read = read_prices(path);
  for (const PriceRow& row : price_rows) CHECK(read.*row.member == prices.*row.member);
  CHECK_THROWS_WITH_AS(static_cast<void>(read_prices(folder.write("unit.json", "{\"unit\": 3}"))),
                       doctest::Contains("unit is no price"), std::runtime_error);
}

// the exit status of a program of this build, its output in a file
int run(const std::string& command, const std::filesystem::path& output) {
  const int status = std::system((command + " >" + output.string() + " 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_model(const SyntheticOptions& options, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = encode(synthetic_model(options));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

TEST_CASE("the program's files are what greenloop-stress and a compiler take") {
  const TemporaryFolder folder("greenloop_calibrate");
  const std::filesystem::path body = folder.path() / "body.gloop", out = folder.path() / "out";
  const std::string file = (folder.path() / "prices").string();
  write_model({.levels = 3}, body);
  const std::string program = GREENLOOP_CALIBRATE, options = " --contacts 8 --cycles 600 --json -o " + file;
  REQUIRE(run(program + " " + body.string() + options + ".json", out) == 0);
  const auto json = nlohmann::json::parse(text_of(out));
  REQUIRE(json["prices"].size() == price_count);
  const Prices read = read_prices(file + ".json");
  for (std::size_t j = 0; j < price_count; ++j) {
    CHECK(json["prices"][j]["name"] == price_rows[j].name);
    CHECK(json["prices"][j]["price"] == read.*price_rows[j].member / 256.0);
    CHECK(json["prices"][j]["unit"] == "ns");
  }
  const nlohmann::json& ways = json["predicted_over_measured"]["ways"];
  for (const char* way : {"cached", "cached, field", "fresh", "fresh, field"}) {
    CAPTURE(way);
    REQUIRE(ways.contains(way));
    CHECK(ways[way]["p05"] <= ways[way]["median"]);
    CHECK(ways[way]["median"] > 0.3);
    CHECK(ways[way]["median"] < 3);
  }
  CHECK(run(GREENLOOP_STRESS " " + body.string() + " --cycles 200 --contacts 8 --prices " + file + ".json", out) == 0);

  REQUIRE(run(program + " " + body.string() + " " + body.string() + options + ".hpp", out) == 0);
  const std::string use = "#include \"prices.hpp\"\nstatic_assert(greenloop::target_prices().slot > 0);\n";
  const std::string source = folder.write("use.cpp", use).string();
  CHECK(run(GREENLOOP_COMPILER " -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I" GREENLOOP_SOURCE " " + source,
            out) == 0);
}

TEST_CASE("the program counts instructions, the same in every run") {
  const TemporaryFolder folder("greenloop_calibrate_instructions");
  const std::filesystem::path body = folder.path() / "body.gloop", out = folder.path() / "out";
  write_model({.levels = 3}, body);
  const std::string command =
      std::string(GREENLOOP_CALIBRATE) + " " + body.string() + " --instructions --contacts 8 --cycles 400 --json -o ";
  REQUIRE(run(command + (folder.path() / "prices.json").string(), out) == 0);
  const std::string first = text_of(out);
  const auto json = nlohmann::json::parse(first.substr(first.find('{')));
  CHECK(json["prices"][0]["unit"] == "instructions");
  CHECK(json["predicted_over_measured"]["all"]["within"] > 0.9);
  REQUIRE(run(command + (folder.path() / "again.json").string(), out) == 0);
  CHECK(text_of(folder.path() / "prices.json") == text_of(folder.path() / "again.json"));
}

TEST_CASE("the program says what is wrong with what it is given") {
  const TemporaryFolder folder("greenloop_calibrate_errors");
  const std::filesystem::path body = folder.path() / "body.gloop", out = folder.path() / "out";
  const std::string program = std::string(GREENLOOP_CALIBRATE) + " " + body.string();
  write_model({.components = 1, .levels = 2}, body);
  CHECK(run(program, out) == 1);
  CHECK(text_of(out).find("body.gloop") != std::string::npos);
  CHECK(text_of(out).find("elastostatic") != std::string::npos);
  CHECK(run(program + " -o prices.txt", out) == 1);
  CHECK(text_of(out).find("prices.txt: prices are written as .json or .hpp") != std::string::npos);
  const std::filesystem::path solid = folder.path() / "solid.gloop";
  write_model({.levels = 2}, solid);
  CHECK(run(std::string(GREENLOOP_CALIBRATE) + " " + solid.string() + " --costs " +
                folder.write("costs.txt", "12\nmany\n").string(),
            out) == 1);
  CHECK(text_of(out).find("costs.txt: what follows cost 1 is no number") != std::string::npos);
  const std::string broken = std::string(GREENLOOP_CALIBRATE) + " " + folder.write("body.gloop", "no model").string();
  CHECK(run(broken, out) == 1);
  CHECK(text_of(out).find("body.gloop: ") != std::string::npos);
}

}  // namespace
}  // namespace greenloop
