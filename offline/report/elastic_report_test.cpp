#include "offline/report/elastic_report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

const ModelFile& beam() {
  static const ModelFile file = encoded_file(synthetic_multigrid({.cells = 4}));
  return file;
}

bool has(const Report& report, const std::string& part) { return report.html.find(part) != std::string::npos; }

bool draws(const Report& report, const std::string& name) {
  return std::any_of(report.figures.begin(), report.figures.end(), [&](const Figure& f) { return f.name == name; });
}

std::string trace_of(int cycles, int work) {
  std::string text = "time,vertex,force,displacement,kinetic,elastic,residual,cycles,work,budget,status\n";
  for (int i = 0; i < cycles; ++i) {
    text += std::to_string(i * 1e-3) + ",3,0.5,0.01,0.1,0.2,0.001,2," + std::to_string(work) + ",1000,coarser\n";
  }
  return text;
}

std::string snapshot_of(std::size_t vertices) {
  std::string text = "x,y,z\n";
  for (std::size_t v = 0; v < vertices; ++v) text += "0.001,0,0.002\n";
  return text;
}

TEST_CASE("a multigrid model has a page: materials, weight, convergence, memory and grids") {
  const Report report = make_elastic_report(beam(), {.model = "beam.gloop", .trace = {}, .snapshot = {}, .build = {}});
  for (const char* name : {"materials", "sag", "convergence", "bytes"}) {
    CAPTURE(name);
    CHECK(draws(report, name));
  }
  CHECK_FALSE(draws(report, "dragged"));
  REQUIRE(report.missing.size() == 1);
  CHECK(report.missing[0].command.find("--script drag --trace trace.csv") != std::string::npos);
  for (const char* part : {"corotational", "coarsest", "of each cycle more", "data:image/png;base64"}) {
    CAPTURE(part);
    CHECK(has(report, part));
  }
}

TEST_CASE("a drag is drawn and judged") {
  const TemporaryFolder folder("elastic_report");
  const std::size_t shown = beam().view.multigrid.info->shown;
  const auto with = [&](const std::string& trace, std::size_t vertices) {
    return make_elastic_report(beam(), {.model = "beam.gloop",
                                        .trace = folder.write("trace.csv", trace),
                                        .snapshot = folder.write("snapshot.csv", snapshot_of(vertices)),
                                        .build = {}});
  };
  const Report held = with(trace_of(50, 900), shown);
  for (const char* name : {"dragged", "force", "displacement"}) CHECK(draws(held, name));
  CHECK(held.missing.empty());
  CHECK(has(held, "The run held its budget in every cycle."));
  CHECK(has(with(trace_of(50, 1100), shown), "The run missed its budget."));
  CHECK(message_of([&] { (void)with("time,force\n0,1\n", shown); }).find("displacement") != std::string::npos);
  CHECK(message_of([&] { (void)with(trace_of(0, 1), shown); }).find("no cycle") != std::string::npos);
  CHECK(message_of([&] { (void)with(trace_of(9, 1), shown + 1); }).find("take a snapshot of this model") !=
        std::string::npos);
  CHECK(message_of([&] {
          (void)make_elastic_report(beam(),
                                    {.model = "beam.gloop", .trace = {}, .snapshot = {}, .build = "build.json"});
        }).find("is a multigrid model; leave it out") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
