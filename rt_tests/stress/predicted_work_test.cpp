#include "rt_tests/stress/predicted_work.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/harness/prices_file.hpp"
#include "rt_tests/stress/starved_steps.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

TEST_CASE("steps are read as they were written, refused ones too") {
  std::stringstream text;
  write_steps({{"cached, field", 12}, {"", 0}, {"fresh", 7}}, text);
  const auto steps = read_steps(text);
  REQUIRE(steps.size() == 3);
  CHECK(steps[0].way == "cached, field");
  CHECK(steps[0].work == 12);
  CHECK(steps[1].way.empty());
  CHECK(steps[2].work == 7);
}

TEST_CASE("ratios are of answered steps, by their ways; as many must be counted as were reported") {
  const std::vector<ReportedStep> steps = {{"cached", 10}, {"fresh", 30}, {"", 5}, {"cached", 20}};
  const PredictedWork compared = compare(steps, {10, 10, 1, 10});
  CHECK(compared.all.steps == 3);
  CHECK(compared.all.least == 1);
  CHECK(compared.all.median == 2);
  CHECK(compared.all.most == 3);
  CHECK(compared.ways.at("fresh").steps == 1);
  CHECK(compared.ways.at("cached").most == 2);
  CHECK(compared.heaviest_instructions == 10);
  CHECK_THROWS_WITH_AS(compare(steps, {10, 10}), "4 steps were reported and 2 were counted", std::invalid_argument);
}

TEST_CASE("the steps of all scripts are run, each as in the checked run, and the heaviest last") {
  const TestModel model({.levels = 3});
  const StressOptions options{.cycles = 700, .seed = 3, .contacts = 8, .factors = 2};
  const auto steps = run_plainly<ElastostaticDriver>(model.model(), options);
  CHECK(steps.size() == 701);
  const StressResult checked = run_stress<ElastostaticDriver>(model.model(), options);
  std::uint64_t worst = 0;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) worst = std::max(worst, steps[i].work);
  CHECK(worst == checked.counts.worst_work);
  const auto released = [](const ReportedStep& step) { return step.way.starts_with("released"); };
  CHECK(std::count_if(steps.begin(), steps.end(), released) >= 50);  // the script of that name
  CHECK(steps.back().way == "fresh, field");
  StressOptions least = options;
  least.budget = 1;
  const auto refused = run_plainly<ElastostaticDriver>(model.model(), least);
  const auto is_answered = [](const ReportedStep& step) { return !step.way.empty(); };
  CHECK(std::count_if(refused.begin(), refused.end(), is_answered) == 1);  // the heaviest
}

TEST_CASE("prices are read by name; what is none is refused by name") {
  const TemporaryFolder folder("greenloop_prices");
  const Prices prices = read_prices(folder.write("some.json", R"({"slot": 1.5, "sorted": 3})").string());
  CHECK(prices.slot == 384);
  CHECK(prices.sorted == 768);
  CHECK(prices.visit == Prices{}.visit);
  const auto refusal = [&](const char* text) {
    try {
      (void)read_prices(folder.write("wrong.json", text).string());
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refusal(R"({"slots": 1})").find("slots is no price") != std::string::npos);
  CHECK(refusal(R"({"slot": -1})").find("slot: -1 is no price") != std::string::npos);
  CHECK(refusal(R"({"slot": "1"})").find("slot: \"1\" is no price") != std::string::npos);
  CHECK(refusal("[1]").find("no JSON object") != std::string::npos);
}

TEST_CASE("work follows prices, and stays within what is declared by them") {
  const TestModel model({.levels = 3});
  StressOptions options{.cycles = 1300, .seed = 5, .contacts = 8, .factors = 2};
  const StressResult by_default = run_stress<ElastostaticDriver>(model.model(), options);
  for (const auto member : {&Prices::scaled_block, &Prices::eliminated, &Prices::node, &Prices::step}) {
    Prices prices;
    prices.*member = 8 * prices.*member + 256;
    options.prices = prices;
    const StressResult dearer = run_stress<ElastostaticDriver>(model.model(), options);
    CHECK(dearer.held());
    CHECK(dearer.declared_work > by_default.declared_work);
    CHECK(dearer.counts.worst_work > by_default.counts.worst_work);
  }
}

// A new contact waits for its part of the factor while the old one is let go at once; 0.001: rounding of other factors.
// A tenth of the budget holds that part in time at four of these places, slightly more at all.
TEST_CASE("starved, a moving tool's force steps as the finest level's does where contacts go before others come") {
  constexpr double share = 0.105;
  const TestModel model({.levels = 4});
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const StressOptions options{.seed = seed, .contacts = 16, .factors = 3};
    const StarvedSteps steps = starved_steps<ElastostaticDriver>(model.model(), options, 400, share);
    MESSAGE("largest step at the finest level ", steps.finest, " N, at ", share, " and a quarter of its work ",
            steps.tenth, " and ", steps.quarter, " of it; of contacts that go before others come ", steps.apart);
    CHECK(steps.finest > 0);
    CHECK(steps.tenth <= std::max(1.5, 1.001 * steps.apart));
    CHECK(steps.quarter <= std::max(1.5, 1.001 * steps.apart));
    if (seed == 1) {
      CHECK(starved_steps<ElastostaticDriver>(model.model(), options, 400, share).tenth == steps.tenth);
    }
  }
}

}  // namespace
}  // namespace greenloop
