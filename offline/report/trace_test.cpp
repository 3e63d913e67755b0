#include "offline/report/trace.hpp"

#include <doctest/doctest.h>

#include <string>

#include "offline/report/temporary_file.hpp"

namespace greenloop::offline {
namespace {

const std::string header = "time,force_x,force_y,force_z,force,contacts,level,field_level,work,budget,status\n";

bool mentions(const std::string& message, std::string_view part) { return message.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a trace is read by column name, whatever their order") {
  const TemporaryFolder folder("trace_test");
  const auto path =
      folder.write("t.csv",
                   "# made by hand\nstatus,time,probe_x,force_x,force_y,force_z,force,contacts,level,field_level,"
                   "work,budget\nok,0.001,9,1,2,2,3,4,3,2,100,200\r\nheld_not_finite,0.002,9,0,0,0,0,0,0,0,0,200\n");
  const auto trace = load_trace(path);
  REQUIRE(trace.size() == 2);
  CHECK(trace[0].time == 0.001);
  CHECK(trace[0].force == Eigen::Vector3d(1, 2, 2));
  CHECK(trace[0].force_size == 3);
  CHECK(trace[0].contacts == 4);
  CHECK(trace[0].level == 3);
  CHECK(trace[0].field_level == 2);
  CHECK(trace[0].work == 100);
  CHECK(trace[0].budget == 200);
  CHECK_FALSE(trace[0].held());
  CHECK(trace[1].held());
}

TEST_CASE("bad traces are refused with file, line, column and value") {
  const TemporaryFolder folder("trace_test");
  const auto refusal = [&](const std::string& content) {
    return message_of([&] { (void)load_trace(folder.write("t.csv", content)); });
  };
  CHECK(mentions(message_of([&] { (void)load_trace(folder.path() / "none.csv"); }), "cannot be read"));
  CHECK(mentions(refusal(""), "column names"));
  CHECK(mentions(refusal(header), "without a single cycle"));
  CHECK(mentions(refusal("time,force\n0,1\n"), "no column 'force_x'; there are: time, force"));
  CHECK(mentions(refusal("time,time\n"), "'time' stands there twice"));
  CHECK(mentions(refusal(header + "0,1,1,1,1,1,1,1,1,1\n"), "t.csv:2: 10 cells where the header has 11"));
  CHECK(mentions(refusal(header + "0,1,nan,1,1,1,1,1,1,1,ok\n"),
                 "t.csv:2: column 'force_y': 'nan' is not a finite number"));
  CHECK(mentions(refusal(header + "0,1,1,1,1,1,1,1,-5,1,ok\n"), "column 'work': '-5' is not a whole number"));
  CHECK(mentions(refusal(header + "0,1,1,1,1,1,1x,1,5,1,ok\n"), "column 'level': '1x'"));
  CHECK(mentions(refusal(header + "1,1,1,1,1,1,1,1,5,9,ok\n1,1,1,1,1,1,1,1,5,9,ok\n"), "time must increase"));
}

TEST_CASE("a summary counts misses, held cycles, levels and the strongest cycle") {
  const std::vector<TraceCycle> trace{
      {.time = 0, .contacts = 0, .work = 0, .budget = 100, .status = "ok"},
      {.time = 1, .force_size = 2, .contacts = 3, .level = 3, .work = 80, .budget = 100, .status = "ok"},
      {.time = 2, .force_size = 9, .contacts = 5, .level = 1, .work = 120, .budget = 100, .status = "coarser"},
      {.time = 3, .force_size = 9, .contacts = 5, .level = 0, .work = 100, .budget = 100, .status = "held_singular"}};
  const TraceSummary summary = summarise(trace);
  CHECK(summary.cycles == 4);
  CHECK(summary.duration == 3);
  CHECK(summary.misses == 1);
  CHECK(summary.held == 1);
  CHECK(summary.in_contact == 3);
  CHECK(summary.strongest == 2);
  CHECK(summary.most_contacts == 5);
  CHECK(summary.worst_work == 120);
  CHECK(summary.worst_share == doctest::Approx(1.2));
  CHECK(summary.cycles_at_level == std::vector<std::size_t>{0, 1, 0, 1});
}

TEST_CASE("a snapshot fills the nodes it lists and refuses what is not of this model") {
  const TemporaryFolder folder("trace_test");
  const auto displacement = load_snapshot(folder.write("s.csv", "node,x,y,z\n2,0.1,0.2,-0.3\n"), 4);
  REQUIRE(displacement.size() == 4);
  CHECK(displacement[2] == Eigen::Vector3d(0.1, 0.2, -0.3));
  CHECK(displacement[0] == Eigen::Vector3d::Zero());
  const auto refusal = [&](const std::string& rows) {
    return message_of([&] { (void)load_snapshot(folder.write("s.csv", "node,x,y,z\n" + rows), 4); });
  };
  CHECK(mentions(refusal("4,0,0,0\n"), "4 in a model of 4 nodes"));
  CHECK(mentions(refusal("1,0,0,0\n1,0,0,0\n"), "1 stands there twice"));
  CHECK(mentions(refusal("1,0,inf,0\n"), "'inf' is not a finite number"));
}

}  // namespace greenloop::offline
