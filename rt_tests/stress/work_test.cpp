// Work units are instructions: what steps report over what Valgrind counts, bounded from both sides, so that a cost
// that is forgotten or charged twice is seen.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/harness/price_table.hpp"
#include "rt_tests/harness/prices_file.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t most_contacts = 12, factors = 3;

// steps of the scripts on a synthetic body, counted
class CountedBody {
 public:
  explicit CountedBody(const SyntheticOptions& options) : model_(options) {
    const std::vector<std::byte> bytes = encode(synthetic_model(options));
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    file_ = folder_.write("body.gloop", text).string();
  }

  // budget: of every step; 0: the scripts'
  [[nodiscard]] PredictedWork run(const Prices& prices, std::uint64_t budget, int cycles) const {
    std::vector<std::string> command = {GREENLOOP_STRESS,
                                        file_,
                                        "--list-steps",
                                        "--contacts",
                                        std::to_string(most_contacts),
                                        "--factors",
                                        std::to_string(factors),
                                        "--cycles",
                                        std::to_string(cycles),
                                        "--prices",
                                        folder_.write("prices.json", prices_as_json(prices, "")).string()};
    if (budget > 0) command.insert(command.end(), {"--budget", std::to_string(budget)});
    std::string out;
    const std::vector<std::uint64_t> instructions = count_step_instructions("Elastostatic", command, out);
    std::istringstream lines(out);
    return compare(read_steps(lines), instructions);
  }

  [[nodiscard]] std::uint64_t least_work() const {
    return Elastostatic::required(model_.model(), ElastostaticDriver::limits(most_contacts, factors)).least_work;
  }

 private:
  TemporaryFolder folder_{"greenloop_work"};
  TestModel model_;
  std::string file_;
};

// of the ways that enough steps are answered: their medians, furthest from 1 on either side
struct Medians {
  double least = 1;
  double most = 1;
  [[nodiscard]] bool are_true() const { return least >= 0.925 && most <= 1.075; }
};

Medians medians_of(const PredictedWork& predicted) {
  constexpr std::uint64_t enough = 20;  // steps
  Medians medians;
  for (const auto& [way, ratios] : predicted.ways) {
    if (ratios.steps < enough) continue;
    medians.least = std::min(medians.least, ratios.median);
    medians.most = std::max(medians.most, ratios.median);
  }
  return medians;
}

TEST_CASE("work is instructions on every way of the planner") {
  std::set<std::string> ways;
  for (const layout::Wavelet wavelet :
       {layout::Wavelet::lifted_linear, layout::Wavelet::butterfly, layout::Wavelet::equilibrated}) {
    CAPTURE(static_cast<int>(wavelet));
    const CountedBody body({.levels = 3, .wavelet = wavelet});
    double within = 0, steps = 0;
    for (const std::uint64_t budget : {std::uint64_t{0}, any_budget, body.least_work()}) {
      const PredictedWork predicted = body.run({}, budget, 650);
      print_ratios(predicted.ways, predicted.all);
      CHECK(predicted.all.least >= 0.67);
      CHECK(medians_of(predicted).are_true());
      within += predicted.all.within * static_cast<double>(predicted.all.steps);
      steps += static_cast<double>(predicted.all.steps);
      for (const auto& [way, ratios] : predicted.ways) ways.insert(way);
    }
    CHECK(within >= 0.95 * steps);
  }
  for (const char* way :
       {"released", "released, field", "cached", "cached, field", "changed", "changed, field", "fresh", "fresh, field",
        "fresh, preparing", "fresh, preparing, field", "cached, preparing, field"}) {
    CAPTURE(way);
    CHECK(ways.count(way) == 1);
  }
}

TEST_CASE("a cost that is forgotten or charged twice is seen") {
  const CountedBody body({.levels = 3});
  for (const auto member : {&Prices::slot, &Prices::layer, &Prices::summed_block}) {
    for (const std::uint32_t times : {0U, 3U}) {
      Prices prices;
      prices.*member *= times;
      const PredictedWork predicted = body.run(prices, any_budget, 325);
      const Medians medians = medians_of(predicted);
      MESSAGE("within " << predicted.all.within << ", least " << predicted.all.least << ", medians " << medians.least
                        << " to " << medians.most);
      CHECK((predicted.all.within < 0.95 || predicted.all.least < 0.67 || !medians.are_true()));
    }
  }
}

}  // namespace
}  // namespace greenloop
