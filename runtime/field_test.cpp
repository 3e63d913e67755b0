#include "runtime/field.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "runtime/domain.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// random forces on a few nodes of K(c), as the runtime and as the reference take them
struct Forces {
  Forces(const ModelView& view, Body& body, std::uint32_t c, std::mt19937_64& random)
      : dense(Eigen::VectorXd::Zero(3 * domain_up_to(view, c))) {
    std::vector<std::uint32_t> places(domain_up_to(view, c));
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      places[i] = i;
    }
    std::shuffle(places.begin(), places.end(), random);
    places.resize(std::min<std::size_t>(places.size(), 5));
    clear(body.touched);
    touch(body.refinement, body.coefficients, c, places.data(), static_cast<std::uint32_t>(places.size()),
          body.touched);
    for (const std::uint32_t place : places) {
      Float4 force{};
      for (int r = 0; r < 3; ++r) {
        force[r] = static_cast<float>(random() >> 40) * 0x1p-24F;
        dense(Eigen::Index{3} * place + r) = force[r];
      }
      body.force[place] = force;
    }
  }
  Eigen::VectorXd dense;
};

bool all_zero(const Float4* x, std::uint32_t count) {
  return std::all_of(x, x + count, [](Float4 v) { return v[0] == 0 && v[1] == 0 && v[2] == 0 && v[3] == 0; });
}

TEST_CASE("a field cut off at a level keeps its averages there, interpolates beyond, and leaves the scratch zero") {
  for (const std::uint32_t layers : {1U, 2U, 3U}) {
    const TestModel model({.levels = 5, .field_layers = layers, .touchable_above = 0.5});
    const ModelView& view = model.view();
    const DenseReference reference(view);
    PlacedBody placed(view, 5);
    Body& body = *placed.body;
    std::mt19937_64 random(8);
    for (std::uint32_t c = 0; c < view.levels; ++c) {
      const Eigen::MatrixXd field = reference.field(c, layers);
      for (std::uint32_t field_level = 0; field_level <= whole_field_level(c, view.levels); ++field_level) {
        CAPTURE(c);
        CAPTURE(field_level);
        const Forces forces(view, body, c, random);
        std::vector<Float4> x(view.node_count, splat(1e30F));
        compute_field({body.refinement, body.coefficients, body.couplings}, body.touched, field_level, body.force,
                      body.sum, x.data());
        CHECK(all_zero(body.force, body.coefficients.count));
        CHECK(all_zero(body.sum, body.coefficients.count));
        for (std::uint32_t q = 0; q < view.levels; ++q) {
          const LevelView& level = view.level[q];
          CHECK(all_zero(x.data() + level.node_begin + level.counts->domain_count,
                         level.counts->node_count - level.counts->domain_count));
          // averages of the next level still join the coarse values
          for (std::uint32_t i = 0; q > field_level && i < level.counts->domain_count; ++i) {
            const std::uint32_t* parent = level.refinement[i].parent;
            CHECK(float{x[level.node_begin + i][1]} == 0.5F * (x[parent[0]][1] + x[parent[1]][1]));
          }
        }
        // averages two levels below the finest force see all of it
        if (field_level + 2 >= c) {
          const Eigen::VectorXd whole = field * forces.dense;
          const Eigen::VectorXd averages = reference.averages(field_level, whole);
          double error = 0;
          for (std::uint32_t place = 0; place < domain_up_to(view, field_level); ++place) {
            const LevelView& level = view.level[body.refinement.level[place]];
            for (int r = 0; r < 3; ++r) {
              const double value = x[level.node_begin + place - level.domain_begin][r];
              error = std::max(error, std::abs(value - averages(Eigen::Index{3} * place + r)));
            }
          }
          CHECK(error <= 1e-5 * whole.cwiseAbs().maxCoeff());
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
