#include "sim_hw/guard/time_verdict.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

namespace greenloop {
namespace {

TimeHistogram measured() {
  TimeHistogram times(100);
  for (int i = 0; i < 99; ++i) times.add(10.5);
  times.add(300);
  return times;
}

TEST_CASE("times are judged against the share of the period") {
  const TimeVerdict half = judge_times(measured(), 1000, 0.5, true);
  CHECK(half.period_us == 1000);
  CHECK(half.p50_us == 11);
  CHECK(half.p99_us == 11);
  CHECK(half.p999_us == 300);
  CHECK(half.worst_us == 300);
  CHECK(half.within());
  CHECK_FALSE(judge_times(measured(), 1000, 0.25, true).within());
  CHECK_FALSE(judge_times(measured(), 4000, 1, true).within());
}

TEST_CASE("a time is judged only where it is asked for and the machine can; asked for in vain it does not hold") {
  TimeVerdict time = judge_times(measured(), 1000, 0.25, false);
  CHECK(time.word() == "NOT JUDGED");
  CHECK(time.holds());
  time.is_asked = true;
  time.unfit = "this thread may run on 2 processors";
  CHECK(time.word() == "NOT JUDGED");
  CHECK_FALSE(time.holds());
  CHECK(time.text("step").find("\n  this thread may run on 2 processors\n") != std::string::npos);
  time.unfit.clear();
  CHECK(time.word() == "LATE");
  CHECK_FALSE(time.holds());
  time.share = 0.5;
  CHECK(time.word() == "WITHIN");
  CHECK(time.holds());
  CHECK(time.text("cycle") ==
        "time WITHIN: p50 11, p99 11, p99.9 300, worst 300 us of processor time a cycle; the period is 1000 us, of "
        "which a step may take 50 %\n");
  CHECK(nlohmann::json(time) == nlohmann::json{{"period_us", 1000.0},
                                               {"share", 0.5},
                                               {"worst_us", 300.0},
                                               {"p50_us", 11.0},
                                               {"p99_us", 11.0},
                                               {"p999_us", 300.0},
                                               {"within", true},
                                               {"can_judge", true}});
}

}  // namespace
}  // namespace greenloop
