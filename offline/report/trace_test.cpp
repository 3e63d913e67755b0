#include "offline/report/trace.hpp"

#include <doctest/doctest.h>

#include <string>

#include "formats/testing/temporary_folder.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

const std::string header =
    "time,x0,y0,z0,force_x0,force_y0,force_z0,force,contacts,level,field_level,work,budget,status\n";

bool mentions(const std::string& message, std::string_view part) { return message.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a trace is read by column name, whatever their order, with every probe") {
  const TemporaryFolder folder("trace_test");
  const auto path = folder.write(
      "t.csv",
      "# made by hand\n"
      "status,time,x0,y0,z0,x1,y1,z1,force_x0,force_y0,force_z0,force_x1,force_y1,force_z1,force,contacts,level,field_"
      "level,work,budget,cpu\n"
      "ok,0.001,1,2,3,4,5,6,1,2,2,0,0,7,10,4,3,2,100,200,x\r\n"
      "held_not_finite,0.002,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,200,x\n");
  const auto trace = load_trace(path);
  REQUIRE(trace.size() == 2);
  CHECK(trace[0].time == 0.001);
  REQUIRE(trace[0].probes.size() == 2);
  CHECK(trace[0].probes[0].force == Eigen::Vector3d(1, 2, 2));
  CHECK(trace[0].probes[1].centre == Eigen::Vector3d(4, 5, 6));
  CHECK(trace[0].force == 10);
  CHECK(trace[0].contacts == 4);
  CHECK(trace[0].level == 3);
  CHECK(trace[0].field_level == 2);
  CHECK(trace[0].work == 100);
  CHECK(trace[0].budget == 200);
  CHECK_FALSE(trace[0].missed());
  CHECK(trace[1].held());
  CHECK(trace[1].missed());
}

TEST_CASE("bad traces are refused with file, line, column and value") {
  const TemporaryFolder folder("trace_test");
  const auto refusal = [&](const std::string& content) {
    return message_of([&] { (void)load_trace(folder.write("t.csv", content)); });
  };
  const std::string probe = "1,1,1,1,1,1";
  CHECK(mentions(message_of([&] { (void)load_trace(folder.path() / "none.csv"); }), "cannot be read"));
  CHECK(mentions(refusal(""), "column names"));
  CHECK(mentions(refusal(header), "without a single cycle"));
  CHECK(mentions(refusal("time,force\n0,1\n"), "no column 'contacts'; there are: time, force"));
  CHECK(mentions(refusal("time,force,contacts,level,field_level,work,budget,status\n0,1,1,1,1,1,1,ok\n"),
                 "no column 'x0'"));
  CHECK(mentions(refusal("time,time\n"), "'time' stands there twice"));
  CHECK(mentions(refusal(header + "0,1,1\n"), "t.csv:2: 3 cells where the header has 14"));
  CHECK(mentions(refusal(header + "0,1,1,1,1,nan,1,1,1,1,1,1,1,ok\n"),
                 "t.csv:2: column 'force_y0': 'nan' is not a finite number"));
  CHECK(mentions(refusal(header + "0," + probe + ",1,1,1,1,-5,1,ok\n"), "column 'work': '-5' is not a whole number"));
  CHECK(mentions(refusal(header + "0," + probe + ",1,1,1x,1,5,1,ok\n"), "column 'level': '1x'"));
  CHECK(mentions(refusal(header + "1," + probe + ",1,1,1,1,5,9,ok\n1," + probe + ",1,1,1,1,5,9,ok\n"),
                 "time must increase"));
}

TEST_CASE(
    "numbers that no run writes are refused: levels that no model has, sizes whose squares overflow, endless files") {
  const TemporaryFolder folder("trace_test");
  const auto refusal = [&](const std::string& row) {
    return message_of([&] { (void)load_trace(folder.write("t.csv", header + row)); });
  };
  const std::string probe = "1,1,1,1,1,1";
  CHECK(refusal("0," + probe + ",1,1,11,11,5,9,ok\n").empty());
  for (const std::string level : {"12", "3000000", "18446744073709551615"}) {
    CHECK(mentions(refusal("0," + probe + ",1,1," + level + ",0,5,9,ok\n"),
                   "column 'level': '" + level + "' is not a whole number of at most 11"));
    CHECK(mentions(refusal("0," + probe + ",1,1,0," + level + ",5,9,ok\n"), "column 'field_level': '" + level));
  }
  CHECK(mentions(refusal("0," + probe + ",1,1,0,0,18446744073709551616,9,ok\n"), "column 'work'"));
  CHECK(mentions(refusal("10000000000000000," + probe + ",1,1,0,0,5,9,ok\n"), "a finite number of at most 1e+12"));
  CHECK(mentions(refusal("0,1,1,1,1e155,1,1,1,1,0,0,5,9,ok\n"), "column 'force_x0': '1e155'"));
  CHECK(mentions(message_of([] { (void)load_trace("/dev/zero"); }), "is longer than 256 MB"));
}

TEST_CASE("a summary counts misses, held cycles, levels and the strongest cycle") {
  const std::vector<TraceCycle> trace{
      {.time = 0, .contacts = 0, .work = 0, .budget = 100, .status = "ok"},
      {.time = 1, .force = 2, .contacts = 3, .level = 3, .work = 80, .budget = 100, .status = "ok"},
      {.time = 2, .force = 9, .contacts = 5, .level = 1, .work = 120, .budget = 100, .status = "coarser"},
      {.time = 3, .force = 9, .contacts = 5, .level = 0, .work = 100, .budget = 100, .status = "held_singular"}};
  const TraceSummary summary = summarise(trace);
  CHECK(summary.cycles == 4);
  CHECK(summary.duration == 3);
  CHECK(summary.misses == 2);
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
  CHECK(mentions(refusal("0,1e155,0,0\n"), "'1e155' is not a finite number of at most 1e+12"));
}

}  // namespace greenloop::offline
