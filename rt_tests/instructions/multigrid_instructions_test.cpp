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

// of what steps report, their instructions: with the least budget, and with two cycles and all answers
Share counted_share(layout::Strain strain) {
  const ModelFile file = encoded_file(synthetic_multigrid({.cells = 1, .grids = 2, .strain = strain}));
  const Model model = Model::open(file.bytes.span()).model;
  const Multigrid::Requirement need = Multigrid::required(model, {});
  AlignedBytes memory(need.bytes);
  Multigrid body = Multigrid::create(model, {}, {memory.data(), memory.size()}).body;
  std::vector<Vec3> displacement(file.view.multigrid.info->vertices);
  std::vector<float> stress(displacement.size());
  Vec3 shown[3];
  const Multigrid::Load load{1, {0, 0.002F, 0}};
  const Multigrid::Hold hold{3, {0, 1e-5F, 0}};
  const auto step = [&](bool more) {
    const std::uint64_t work = need.least_work + (more ? need.cycle_work + need.shown_work + need.stress_work : 0);
    const Multigrid::Response response{.displacement = displacement,
                                       .shown = more ? std::span<Vec3>(shown) : std::span<Vec3>(),
                                       .stress = more ? std::span<float>(stress) : std::span<float>()};
    return body.step({.loads = {&load, 1}, .holds = {&hold, more ? 1U : 0U}}, {work}, response);
  };
  Share share;
  for (const bool more : {false, true}) {
    instruction_counter::start();
    const Multigrid::StepReport report = step(more);
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
    const Share share = counted_share(strain);
    MESSAGE("strain ", static_cast<int>(strain), ": ", share.least, " to ", share.most, " of the work reported");
    CHECK(share.most <= 1.0);
    CHECK(share.least >= 0.7);
  }
}

}  // namespace
}  // namespace greenloop
