#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/encode/compressed_compliance.hpp"
#include "offline/compress/testing/measured_model.hpp"
#include "offline/compress/testing/solved_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop::offline {
namespace {

struct Units {
  double length = 1;  // m
  double young = 1;   // Pa
};

// forces and fields of a thin-eared ball of this size and stiffness, in units of young * length^2 and length, and some
// columns of the compliance that its model stands for, in units of 1 / (young * length)
struct Answers {
  std::vector<double> force, field, compliance;
};

Answers answers(const Units& units) {
  auto mesh = test::eared_ball(2);
  for (auto& position : mesh.positions) position *= units.length;
  const auto body =
      test::solve_body(mesh, [&](const Eigen::Vector3d& x) { return x.z() < -0.7 * units.length; }, {units.young, 0.3});
  const auto measured = test::measure_model(body);
  CHECK(measured.certified);
  CHECK(measured.patch_force <= test::default_accuracy.patch_force);
  const TestModel model(encode(measured.built.model));
  const auto touchable = model.touchable();
  const CompressedCompliance<3> whole(model.view());
  Answers result;
  for (std::size_t j = 0; j < whole.rows(whole.finest()); j += 20) {
    for (const double u : whole.column(whole.finest(), j)) {
      result.compliance.push_back(u * units.young * units.length);
    }
  }
  TestBody loop(model, {.max_contacts = 8, .cached_factors = 1});
  for (std::uint32_t first = 0; first + 8 <= touchable.size(); first += 8) {
    std::vector<Constraint> contacts;
    for (std::uint32_t i = 0; i < 8; ++i) {
      const auto u = static_cast<float>(1e-3 * units.length);
      contacts.push_back({touchable[first + i], {u, (i & 1U) != 0 ? -u : u, 0}});
    }
    REQUIRE(loop.step(contacts, any_budget).status == Status::ok);
    for (const float f : loop.force()) {
      result.force.push_back(static_cast<double>(f) / (units.young * units.length * units.length));
      CHECK((f == 0 || std::isnormal(f)));
    }
    for (const float u : loop.field()) result.field.push_back(static_cast<double>(u) / units.length);
  }
  return result;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return most / largest;
}

TEST_CASE("units that are powers of two, about a micrometre and a kilometre, change no bit of forces and fields") {
  const Answers metres = answers({1, 1e5});
  for (const Units& units : {Units{0x1p-20, 0x1p-16 * 1e5}, Units{0x1p10, 0x1p20 * 1e5}}) {
    CAPTURE(units.length);
    const Answers scaled = answers(units);
    CHECK(scaled.force == metres.force);
    CHECK(scaled.field == metres.field);
    CHECK(scaled.compliance == metres.compliance);
  }
}

TEST_CASE("micrometres of 1 Pa and kilometres of 100 GPa answer as metres of 100 kPa do, scaled") {
  const Answers metres = answers({1, 1e5});
  for (const Units& units : {Units{1e-6, 1}, Units{1e3, 1e11}}) {
    CAPTURE(units.length);
    const Answers scaled = answers(units);
    const double force = difference(scaled.force, metres.force), field = difference(scaled.field, metres.field);
    MESSAGE("length ", units.length, " m: forces differ by ", force, ", fields by ", field);
    // round-off of the units decides to which of two quanta a value halfway between them goes: one such value moves
    // forces and compliances by one or two ten-thousandths
    CHECK(force < 4e-4);
    CHECK(difference(scaled.compliance, metres.compliance) < 4e-4);
    CHECK(field < 1e-3);  // a field of forces that nearly cancel feels such a value some four times as much
  }
}

}  // namespace
}  // namespace greenloop::offline
