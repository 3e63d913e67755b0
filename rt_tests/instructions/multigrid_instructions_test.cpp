// A step of a multigrid body takes no more instructions than it reports, and not much less.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "formats/testing/synthetic_multigrid.hpp"
#include "rt_tests/instructions/counted.hpp"
#include "runtime/model.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop {
namespace {

struct Share {
  double least = 1e9, most = 0;
};

// of what steps report, their instructions
Share counted_share(layout::Strain strain, bool starved) {
  const ModelFile file = encoded_file(synthetic_multigrid({.cells = 2, .strain = strain}));
  const Model model = Model::open(file.bytes.span()).model;
  const Multigrid::Limits limits{.tolerance = 1e-3F};
  const Multigrid::Requirement need = Multigrid::required(model, limits);
  AlignedBytes memory(need.bytes);
  Multigrid body = Multigrid::create(model, limits, {memory.data(), memory.size()}).body;
  std::vector<Vec3> displacement(file.view.multigrid.info->vertices);
  std::vector<float> stress(displacement.size());
  Vec3 shown[3];
  Share share;
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Multigrid::Load load{5, {0, 0.002F, 0}};
    const Multigrid::Hold hold{7, {0, 1e-4F * static_cast<float>(i), 0}};
    const bool answers = i % 2 == 1;
    const std::uint64_t more = answers ? need.shown_work + need.stress_work : 0;
    const Budget budget{(starved ? 1 : 2) * need.least_work + more};
    const Multigrid::Response response{.displacement = displacement,
                                       .shown = answers ? std::span<Vec3>(shown) : std::span<Vec3>(),
                                       .stress = answers ? std::span<float>(stress) : std::span<float>()};
    Multigrid::StepReport report;
    instruction_counter::start();
    report = body.step({.loads = {&load, 1}, .holds = {&hold, i % 3 == 0 ? 0U : 1U}}, budget, response);
    const std::uint64_t counted = instruction_counter::stop();
    REQUIRE(answered(report.status));
    const double of_reported = static_cast<double>(counted) / static_cast<double>(report.work);
    share.least = std::min(share.least, of_reported);
    share.most = std::max(share.most, of_reported);
  }
  return share;
}

TEST_CASE("a step of a multigrid body is as dear as it says") {
  if (!instruction_counter::install()) {
    MESSAGE("instructions cannot be counted on this processor; nothing is compared");
    return;
  }
  for (const layout::Strain strain : {layout::Strain::linear, layout::Strain::corotational, layout::Strain::green}) {
    for (const bool starved : {true, false}) {
      const Share share = counted_share(strain, starved);
      MESSAGE("strain " << static_cast<int>(strain) << (starved ? ", least budget: " : ", twice that: ") << share.least
                        << " to " << share.most << " of the work reported");
      CHECK(share.most <= 1.0);
      CHECK(share.least >= 0.7);
    }
  }
}

}  // namespace
}  // namespace greenloop
