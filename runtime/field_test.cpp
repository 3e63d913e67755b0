#include "runtime/field.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "runtime/domain.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// random forces on a few touchable nodes of K(c), as the runtime and as the reference take them
struct Forces {
  Forces(const ModelView& view, std::uint32_t c, std::mt19937_64& random)
      : dense(Eigen::VectorXd::Zero(Eigen::Index{3} * domain_up_to(view, c))) {
    for (std::uint32_t q = 0; q <= c; ++q) {
      for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
        if ((view.level[q].nodes[i].flags & layout::node_touchable) != 0) {
          place.push_back(view.level[q].domain_begin + i);
        }
      }
    }
    std::shuffle(place.begin(), place.end(), random);
    place.resize(std::min<std::size_t>(place.size(), 5));
    for (const std::uint32_t at : place) {
      for (int r = 0; r < 3; ++r) {
        force.push_back(static_cast<float>(random() >> 40) * 0x1p-24F);
        dense(Eigen::Index{3} * at + r) = double{force.back()};
      }
    }
  }
  [[nodiscard]] ColumnForces on(std::uint32_t c) const {
    column.clear();
    for (const std::uint32_t at : place) {
      column.push_back(make_column(c, at));
    }
    return {static_cast<std::uint32_t>(place.size()), column.data(), force.data()};
  }
  std::vector<std::uint32_t> place;
  mutable std::vector<std::uint32_t> column;
  std::vector<float> force;
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

// what the coarser levels say of node i of a level
float interpolated(const LevelView& level, std::uint32_t i, const std::vector<Float4>& x) {
  const auto at = [&](std::uint32_t node) { return float{x[node][1]}; };
  const std::uint32_t* parent = level.refinement[i].parent;
  float value = 0.5F * (at(parent[0]) + at(parent[1]));
  if (level.stencils != nullptr && level.stencils[i].wing[0] != layout::none) {
    const auto& [wing, outer] = level.stencils[i];
    value += 0.125F * (at(wing[0]) + at(wing[1]));
    value += -0.0625F * ((at(outer[0]) + at(outer[1])) + (at(outer[2]) + at(outer[3])));
  }
  return value;
}

TEST_CASE("a field cut off at a level keeps its averages there, interpolates beyond, and leaves the scratch zero") {
  const ModelData models[] = {synthetic_model({.levels = 5, .touchable_above = 0.5}),
                              synthetic_model({.levels = 5, .field_threshold = 0.01, .touchable_above = 0.5}),
                              synthetic_model({.levels = 4, .field_threshold = 0, .epsilon = 0, .quantum = 0}),
                              synthetic_model({.levels = 4, .wavelet = layout::Wavelet::linear}),
                              synthetic_model({.levels = 5, .wavelet = layout::Wavelet::lifted_butterfly}),
                              synthetic_model({.levels = 4, .wavelet = layout::Wavelet::butterfly, .epsilon = 0})};
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
        const Forces forces(view, c, random);
        std::vector<Float4> x(view.node_count, splat(1e30F));
        compute_field({view, body.columns, body.parents}, forces.on(c), {view.levels - 1, field_level},
                      body.field_scratch(), x.data());
        CHECK(std::count(body.field_touched, body.field_touched + view.domain_count, 0) == view.domain_count);
        CHECK(all_zero(body.force, view.domain_count));
        for (std::uint32_t q = 0; q < view.levels; ++q) {
          const LevelView& level = view.level[q];
          CHECK(all_zero(x.data() + level.node_begin + level.counts->domain_count,
                         level.counts->node_count - level.counts->domain_count));
          for (std::uint32_t i = 0; q > field_level && i < level.counts->domain_count; ++i) {
            CHECK(float{x[level.node_begin + i][1]} == interpolated(level, i, x));
          }
        }
        std::vector<Float4> coarse(nodes_up_to(view, field_level), splat(1e30F));
        compute_field({view, body.columns, body.parents}, forces.on(c), {field_level, field_level},
                      body.field_scratch(), coarse.data());
        CHECK(std::memcmp(coarse.data(), x.data(), sizeof(Float4) * coarse.size()) == 0);
        const Eigen::VectorXd whole = reference.field(c) * forces.dense;
        const Eigen::VectorXd averages = reference.averages(field_level, whole);
        CHECK(averages_error(body, averages, x) <= 1e-5 * whole.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST_CASE("columns hold the blocks that the thresholds keep, rounded to 8 significant bits, and no others") {
  for (const ModelData& data :
       {synthetic_model({.levels = 4}),
        synthetic_model({.levels = 3, .wavelet = layout::Wavelet::linear, .field_threshold = 0.01}),
        synthetic_model({.levels = 4, .coarsest_constraint_level = 1, .field_threshold = 0}),
        synthetic_model({.levels = 4, .field_halves = 2}), synthetic_model({.levels = 4, .read_above = 0.6}),
        synthetic_model({.levels = 4, .wavelet = layout::Wavelet::butterfly, .read_above = 0.6})}) {
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const PlacedBody placed(view, 5);
    for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
      const Eigen::MatrixXd expected = field_columns(data, c);
      const Eigen::MatrixXd found = dense_field_columns(*placed.body, c);
      for (std::uint32_t place = 0; place < domain_up_to(view, c); ++place) {
        const std::uint32_t q = placed.body->refinement.level[place];
        const std::uint32_t flags = view.level[q].nodes[place - view.level[q].domain_begin].flags;
        const bool wanted = (flags & layout::node_touchable) != 0;
        for (Eigen::Index i = 0; i < found.rows(); i += 3) {
          const Eigen::Matrix3d block = expected.block<3, 3>(i, Eigen::Index{3} * place);
          const Eigen::Matrix3d stored = found.block<3, 3>(i, Eigen::Index{3} * place);
          CHECK(stored.isZero(0) == (block.isZero(0) || !wanted));
          // single precision may round to the other neighbour
          CHECK(
              (!wanted || (stored - block).norm() <= (data.info.field_halves == 1 ? 0x1p-7 : 0x1p-14) * block.norm()));
        }
      }
    }
    CHECK(placed.body->columns.begin[view.levels - 1][view.domain_count * view.levels] ==
          view.level[view.levels - 1].counts->field_blocks);
  }
}

}  // namespace
}  // namespace greenloop
