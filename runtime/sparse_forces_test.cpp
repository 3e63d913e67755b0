#include "runtime/sparse_forces.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/domain.hpp"
#include "runtime/support.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// coefficients of nodal forces of level c, by T_l^-T as dense matrices, in the runtime's numbering
std::vector<double> dense_coefficients(const ModelView& view, const Coefficients& coefficients,
                                       const std::vector<Eigen::SparseMatrix<double>>& inverse, std::uint32_t c,
                                       Eigen::VectorXd f) {
  std::vector<double> result(coefficients.count);
  const auto keep = [&](std::uint32_t group, const Eigen::VectorXd& values) {
    for (Eigen::Index i = 0; i < values.size() / 3; ++i) {
      result[coefficients.group[group].begin + static_cast<std::size_t>(i)] = values(3 * i);
    }
  };
  for (std::uint32_t level = c + 1; level-- > 0;) {
    if (level <= coefficients.last_averages) {
      keep(Coefficients::averages(level), f);
    }
    if (level > 0) {
      const Eigen::VectorXd g = inverse[level].transpose() * f;
      const Eigen::Index coarse = 3 * domain_up_to(view, level - 1);
      keep(Coefficients::details(level), g.tail(g.size() - coarse));
      f = g.head(coarse);
    }
  }
  return result;
}

TEST_CASE("sparse forces reach the coefficients that the dense transform finds, and no other") {
  for (const bool lifted : {true, false}) {
    const TestModel model({.levels = 5, .lifted = lifted, .touchable_above = 0.8});
    const ModelView& view = model.view();
    PlacedBody placed(view, 16);
    Body& body = *placed.body;
    std::uint32_t most_neighbours[layout::max_levels] = {};
    std::vector<Eigen::SparseMatrix<double>> inverse(view.levels);
    for (std::uint32_t q = 1; q < view.levels; ++q) {
      inverse[q] = inverse_step(view, q);
      most_neighbours[q] = count_lifting(view, q).most_neighbours;
      CHECK(most_neighbours[q] == (q == 1 ? 4 : 6));  // an octahedron's corners have four edges
    }
    std::mt19937_64 random(3);
    for (std::uint32_t c = 0; c < view.levels; ++c) {
      const ReachBound reach = bound_reach(view, c, most_neighbours);
      REQUIRE(reach.bounded);
      for (int trial = 0; trial < 30; ++trial) {
        std::vector<std::uint32_t> places(domain_up_to(view, c));
        for (std::uint32_t i = 0; i < places.size(); ++i) {
          places[i] = i;
        }
        std::shuffle(places.begin(), places.end(), random);
        places.resize(std::min<std::size_t>(places.size(), trial < 15 ? 1 : 16));
        Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * domain_up_to(view, c));
        touch(body.refinement, body.coefficients, c, places.data(), static_cast<std::uint32_t>(places.size()),
              body.touched);
        for (const std::uint32_t place : places) {
          const float value = static_cast<float>(random() >> 40) * 0x1p-24F;
          f(Eigen::Index{3} * place) = value;
          body.force[place] = splat3(value);
        }
        transform_forces(body.refinement, body.coefficients, body.touched, body.force);
        const auto dense = dense_coefficients(view, body.coefficients, inverse, c, f);
        std::vector<int> times(dense.size());
        for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
          const CoefficientGroup& group = body.coefficients.group[g];
          for (std::uint32_t k = 0; k < body.touched.count[g]; ++k) {
            CHECK(body.touched.list[g][k] - group.begin < group.count);
            ++times[body.touched.list[g][k]];
          }
          const bool averages = g == 0 || !Coefficients::has_diagonal(g);
          if (group.level <= c && group.count > 0) {
            CHECK(body.touched.count[g] <=
                  places.size() * (averages ? reach.averages[group.level] : reach.details[group.level]));
          }
        }
        CHECK(body.touched.visits <= places.size() * reach.visits);
        for (std::size_t i = 0; i < dense.size(); ++i) {
          CHECK(times[i] <= 1);
          CHECK(std::abs(double{body.force[i][0]} - dense[i]) <= 1e-5);
          CHECK((times[i] == 1 || dense[i] == 0));
        }
        clear_forces(body.touched, body.force);
        clear(body.touched);
        CHECK(std::none_of(body.touched.mark, body.touched.mark + view.domain_count, [](bool m) { return m; }));
        CHECK(std::all_of(body.force, body.force + body.coefficients.count,
                          [](Float4 x) { return x[0] == 0 && x[1] == 0 && x[2] == 0 && x[3] == 0; }));
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
