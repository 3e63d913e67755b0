// No heap and no lock while tools touch a body that vibrates.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>

#include "formats/testing/synthetic_motion.hpp"
#include "rt_tests/harness/minor_faults.hpp"
#include "rt_tests/harness/touching_script.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/vibrating_body.hpp"
#include "runtime/wavelet/domain.hpp"
#include "sim_hw/guard/guarded.hpp"

namespace greenloop {
namespace {

constexpr int cycles = 2000;

// motions that have a vertex at the place of each node
ImpulseResponseData motions_of(const TestModel& touched) {
  const std::uint32_t nodes = touched.model().node_count();
  ImpulseResponseData data = synthetic_motion({.vertices = nodes, .alternating = true});
  for (std::uint32_t i = 0; i < nodes; ++i) {
    std::copy_n(node_record(touched.view(), i).position, 3, data.shape.begin() + std::ptrdiff_t{3} * i);
  }
  return data;
}

// the same tools on a body that vibrates, with impulses of which some may not follow
class Vibrating {
 public:
  Vibrating()
      : touched_({.levels = 3}),
        moving_(encode(motions_of(touched_))),
        limits_{TouchingScript::limits(64, 30), {}},
        need_(VibratingBody::required(touched_.model(), moving_.model(), limits_)),
        memory_(need_.bytes),
        body_(VibratingBody::create(touched_.model(), moving_.model(), limits_, {memory_.data(), memory_.size()}).body),
        script_(touched_.model(), ContactBody::required(touched_.model(), limits_.contact), 3) {}

  VibratingBody::StepReport cycle(std::uint32_t i) {
    const TouchingScript::Cycle cycle = script_.next(body_.contact());
    const std::uint32_t impulse = i % 10 == 0 ? i / 10 % 4 : ImpulseResponse::no_impulse;
    return body_.step(impulse, cycle.tools, {}, {i % 3 == 0 ? need_.least_work : need_.worst_work});
  }

 private:
  TestModel touched_, moving_;
  VibratingBody::Limits limits_;
  VibratingBody::Requirement need_;
  AlignedBytes memory_;
  VibratingBody body_;
  TouchingScript script_;
};

TEST_CASE("no allocation, lock or minor page fault in steps of tools on a body that vibrates") {
  Vibrating vibrating;
  for (std::uint32_t i = 0; i < 100; ++i) vibrating.cycle(i);
  GuardCounts seen;
  int refused = 0, pushed = 0;
  const std::uint64_t faults = minor_faults();
  for (std::uint32_t i = 0; i < cycles; ++i) {
    VibratingBody::StepReport report;
    seen += guarded([&] { report = vibrating.cycle(i); });
    refused += answered(report.motion.status) ? 0 : 1;
    pushed += report.contact.iterations > 0 ? 1 : 0;
  }
  CHECK(minor_faults() == faults);
  CHECK(seen.allocations == 0);
  CHECK(seen.locks == 0);
  CHECK(refused > 0);
  CHECK(pushed > cycles / 2);
}

}  // namespace
}  // namespace greenloop
