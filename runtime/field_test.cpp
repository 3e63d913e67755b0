#include "runtime/field.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "formats/field_block.hpp"
#include "runtime/domain.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// random forces on a few nodes of K(c), as the runtime and as the reference take them
struct Forces {
  Forces(const ModelView& view, Body& body, std::uint32_t c, std::mt19937_64& random)
      : dense(Eigen::VectorXd::Zero(Eigen::Index{3} * domain_up_to(view, c))) {
    std::vector<std::uint32_t> places(domain_up_to(view, c));
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      places[i] = i;
    }
    std::shuffle(places.begin(), places.end(), random);
    places.resize(std::min<std::size_t>(places.size(), 5));
    clear(body.touched);
    touch(body.refinement, c, places.data(), static_cast<std::uint32_t>(places.size()), body.touched);
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

// largest deviation of the averages of K(field_level) that x starts with
double averages_error(const Body& body, const Eigen::VectorXd& averages, const std::vector<Float4>& x) {
  double error = 0;
  for (Eigen::Index place = 0; place < averages.size() / 3; ++place) {
    const LevelView& level = body.view->level[body.refinement.level[place]];
    for (int r = 0; r < 3; ++r) {
      const double value = x[level.node_begin + static_cast<std::size_t>(place) - level.domain_begin][r];
      error = std::max(error, std::abs(value - averages(3 * place + r)));
    }
  }
  return error;
}

// what the numbers mean does not matter
ModelData with_one_quantum(ModelData data) {
  std::fill(std::begin(data.info.quantum), std::end(data.info.quantum), data.info.quantum[0]);
  return data;
}

TEST_CASE("a field cut off at a level keeps its averages there, interpolates beyond, and leaves the scratch zero") {
  const ModelData models[] = {synthetic_model({.levels = 5, .touchable_above = 0.5}),
                              synthetic_model({.levels = 5, .field = 0.05, .touchable_above = 0.5}),
                              synthetic_model({.levels = 4, .epsilon = 0, .quantum = 0}),
                              with_one_quantum(synthetic_model({.levels = 4}))};
  for (const ModelData& data : models) {
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const DenseReference reference(data);
    const PlacedBody placed(view, 5);
    Body& body = *placed.body;
    std::mt19937_64 random(8);
    for (std::uint32_t c = 0; c < view.levels; ++c) {
      for (std::uint32_t field_level = 0; field_level < view.levels; ++field_level) {
        CAPTURE(c);
        CAPTURE(field_level);
        const Forces forces(view, body, c, random);
        std::vector<Float4> x(view.node_count, splat(1e30F));
        compute_field({body.refinement, body.couplings}, body.touched, field_level, body.force, x.data());
        CHECK(all_zero(body.force, view.domain_count));
        for (std::uint32_t q = 0; q < view.levels; ++q) {
          const LevelView& level = view.level[q];
          CHECK(all_zero(x.data() + level.node_begin + level.counts->domain_count,
                         level.counts->node_count - level.counts->domain_count));
          for (std::uint32_t i = 0; q > field_level && i < level.counts->domain_count; ++i) {
            const std::uint32_t* parent = level.refinement[i].parent;
            CHECK(float{x[level.node_begin + i][1]} == 0.5F * (x[parent[0]][1] + x[parent[1]][1]));
          }
        }
        const Eigen::VectorXd whole = reference.field(c) * forces.dense;
        const Eigen::VectorXd averages = reference.averages(field_level, whole);
        CHECK(averages_error(body, averages, x) <= 1e-5 * whole.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST_CASE("the blocks of a field are those between what is touched and what is kept, and no work is left uncounted") {
  const ModelData data = synthetic_model({.levels = 4});
  const TestModel model(encode(data));
  const ModelView& view = model.view();
  const PlacedBody placed(view, 5);
  Body& body = *placed.body;
  std::mt19937_64 random(9);
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    const Forces forces(view, body, c, random);
    clear_forces(body.touched, body.force);
    std::vector<std::uint32_t> times(view.domain_count);
    for (std::uint32_t q = 0; q <= c; ++q) {
      for (std::uint32_t k = 0; k < body.touched.count[q]; ++k) {
        ++times[body.touched.list[q][k]];
      }
    }
    for (std::uint32_t field_level = 0; field_level < view.levels; ++field_level) {
      const std::uint32_t end = domain_up_to(view, field_level);
      std::uint64_t blocks = 0;
      for (std::uint32_t q = 0; q < view.levels; ++q) {
        for (std::uint32_t layer = 0; layer < layout::field_layers; ++layer) {
          const CouplingsData& couplings = data.levels[q].couplings[layer];
          for (std::uint32_t j = 0; j + 1 < couplings.begin.size(); ++j) {
            const std::uint32_t column = view.level[q].domain_begin + j;
            for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
              const std::uint32_t row = couplings.index[b];
              const std::uint32_t seen = (row < end ? times[column] : 0) + (column < end ? times[row] : 0);
              blocks += std::uint64_t{field_halves(data.info)} * seen;
            }
          }
        }
      }
      CHECK(count_field_blocks(body.couplings, body.touched, field_level) == blocks);
    }
  }
}

}  // namespace
}  // namespace greenloop
