#include "runtime/elastostatic.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

std::vector<Contact> random_contacts(std::mt19937_64& random, std::vector<std::uint32_t> nodes, std::size_t count) {
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < std::min(count, nodes.size()); ++i) {
    std::swap(nodes[i], nodes[i + random() % (nodes.size() - i)]);
    Contact contact{nodes[i], {}};
    for (float& u : contact.displacement) {
      u = (static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F) * 1e-3F;
    }
    contacts.push_back(contact);
  }
  return contacts;
}

double relative_error(std::span<const float> computed, std::size_t stride, const Eigen::VectorXd& reference) {
  double error = 0;
  for (Eigen::Index i = 0; i < reference.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    error = std::max(error, std::abs(computed[k / 3 * stride + k % 3] - reference(i)));
  }
  return error / reference.cwiseAbs().maxCoeff();
}

TEST_CASE("every constraint level agrees with a dense double-precision solution of the columns in the file") {
  for (const auto& options :
       {SyntheticOptions{.levels = 4, .value_bytes = 2, .dense = true},
        SyntheticOptions{.levels = 4, .value_bytes = 1, .epsilon = 0.02},
        SyntheticOptions{.levels = 3, .value_bytes = 2, .epsilon = 0.05}, SyntheticOptions{.levels = 1}}) {
    const TestModel model(options);
    TestBody body(model, {.max_contacts = 20, .cached_factors = 4});
    const std::uint64_t seed = 7;
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    std::vector<Eigen::MatrixXd> columns;
    for (std::uint32_t c = 0; c < model.view().levels; ++c) {
      columns.push_back(decode_columns(model.view(), c));
    }
    std::uint32_t levels_seen = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const auto contacts = random_contacts(random, model.touchable(), 1 + random() % 20);
      const auto& need = body.requirement();
      const std::uint64_t budget = trial % 4 == 0 ? any_budget : need.least_work + random() % need.worst_work[0];
      const StepReport report = body.step(contacts, budget);
      REQUIRE(report.status <= Status::coarser);
      const std::uint32_t c = report.constraint_level;
      levels_seen |= 1U << c;
      const DenseAnswer dense = solve_dense(model.view(), c, columns[c], contacts);
      // float rounding of the matrix, the factors and the sums, amplified by the condition
      const double tolerance = 60 * dense.condition * 0x1p-24;
      CHECK(relative_error(body.force(), 3, dense.force) <= tolerance);
      if (report.field_level + 1 == model.view().levels) {
        CHECK(relative_error(body.field(), 4, dense.displacement) <= tolerance);
      }
    }
    CHECK((levels_seen & 1U << (model.view().levels - 1)) != 0);
  }
}

}  // namespace
}  // namespace greenloop
