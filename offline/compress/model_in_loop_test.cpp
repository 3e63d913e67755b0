#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "formats/aligned_bytes.hpp"
#include "offline/compress/model_builder.hpp"
#include "offline/compress/test_body.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t contact_count = 8;

struct Press {
  std::vector<Contact> contacts;
  std::vector<Eigen::Index> rows;  // of the contacts in the compliance
};

/// The columns nearest to column `seed`, pressed 1 mm inwards and a little sideways.
Press press_around(const test::Body& body, std::size_t seed) {
  const Eigen::Vector3d centre = body.mesh.positions[body.column_nodes[seed]];
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t j = 0; j < body.column_nodes.size(); ++j) {
    nearest.emplace_back((body.mesh.positions[body.column_nodes[j]] - centre).norm(), j);
  }
  std::sort(nearest.begin(), nearest.end());
  const Eigen::Vector3f push = (-1e-3 * centre.normalized() + Eigen::Vector3d(2e-4, 0, 1e-4)).cast<float>();
  Press press;
  for (std::size_t i = 0; i < contact_count; ++i) {
    const std::size_t j = nearest[i].second;
    press.rows.push_back(static_cast<Eigen::Index>(j));
    press.contacts.push_back({static_cast<std::uint32_t>(body.column_nodes[j]), {push.x(), push.y(), push.z()}});
  }
  return press;
}

/// Forces and field of the exact dense compliance.
struct Dense {
  Eigen::VectorXd force, field;
};
Dense solve_dense(const test::Body& body, const Press& press) {
  const auto n = static_cast<Eigen::Index>(press.rows.size());
  Eigen::MatrixXd columns(body.compliance.rows(), 3 * n), contact(3 * n, 3 * n);
  Eigen::VectorXd held(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = press.rows[static_cast<std::size_t>(i)];
    columns.middleCols(3 * i, 3) = body.compliance.middleCols(3 * row, 3);
    for (Eigen::Index k = 0; k < 3; ++k) {
      held(3 * i + k) = static_cast<double>(press.contacts[static_cast<std::size_t>(i)].displacement[k]);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    contact.middleRows(3 * i, 3) = columns.middleRows(3 * press.rows[static_cast<std::size_t>(i)], 3);
  }
  Dense dense;
  dense.force = contact.partialPivLu().solve(held);
  dense.field = columns * dense.force;
  return dense;
}

TEST_CASE("the loop answers from a built model what the exact compliance says") {
  const auto body = test::make_body(3);
  layout::Info facts{};
  facts.young = 1e5;
  facts.rate = 1000;
  facts.max_contacts = contact_count;
  const ColumnSource source = [&](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return body.compliance.middleCols(static_cast<Eigen::Index>(3 * first), static_cast<Eigen::Index>(3 * count));
  };
  const auto built =
      build_model({body.mesh, body.flags, body.area, body.column_nodes, source, {0.005, 0.01}, facts, ""}, {});
  const AlignedBytes file(encode(built.model));
  const auto opened = Model::open(file.span());
  REQUIRE(opened);
  const Limits limits{.max_contacts = contact_count, .cached_factors = 2};
  const auto need = Elastostatic::required(opened.model, limits);
  AlignedBytes memory(need.bytes);
  auto created = Elastostatic::create(opened.model, limits, {memory.data(), memory.size()});
  REQUIRE(created);

  const std::size_t nodes = body.mesh.positions.size();
  std::vector<float> force(3 * contact_count);
  AlignedBytes field_bytes(4 * sizeof(float) * nodes);
  auto* field = reinterpret_cast<float*>(field_bytes.data());
  for (const std::size_t seed : {std::size_t{40}, std::size_t{200}, std::size_t{430}}) {
    CAPTURE(seed);
    const auto press = press_around(body, seed);
    const auto report = created.body.step(press.contacts, {.work = need.worst_work[3]}, {force, {field, 4 * nodes}});
    REQUIRE(report.status == Status::ok);
    CHECK(report.constraint_level == 3);
    const auto dense = solve_dense(body, press);
    const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXf>(force.data(), 3 * contact_count).cast<double>();
    CHECK((found - dense.force).norm() < 0.05 * dense.force.norm());
    double error = 0;
    for (std::size_t i = 0; i < body.column_nodes.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double u = static_cast<double>(field[4 * body.column_nodes[i] + k]);
        error = std::max(error, std::abs(u - dense.field(static_cast<Eigen::Index>(3 * i + k))));
      }
    }
    CHECK(error < 0.02 * dense.field.cwiseAbs().maxCoeff());
    for (std::size_t node = 0; node < nodes; ++node) {
      if ((body.flags[node] & layout::node_fixed) != 0) CHECK(field[4 * node] == 0.0F);
    }
  }
}

}  // namespace
}  // namespace greenloop::offline
