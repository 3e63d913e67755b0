#include "runtime/compliance/field.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// random forces on a few touchable nodes of K(c), as the runtime and as the reference take them
template <unsigned N>
struct Forces {
  Forces(const ModelView& view, std::uint32_t c, std::mt19937_64& random)
      : dense(Eigen::VectorXd::Zero(Eigen::Index{N} * domain_up_to(view, c))) {
    for (std::uint32_t q = 0; q <= c; ++q) {
      for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
        if ((view.level[q].nodes[i].flags & layout::node_touchable) != 0) {
          place.push_back(view.level[q].domain_begin + i);
        }
      }
    }
    std::shuffle(place.begin(), place.end(), random);
    place.resize(std::min<std::size_t>(place.size(), 5));
    std::sort(place.begin(), place.end());
    for (const std::uint32_t at : place) {
      for (unsigned r = 0; r < N; ++r) {
        force.push_back(static_cast<float>(random() >> 40) * 0x1p-24F);
        dense(Eigen::Index{N} * at + r) = double{force.back()};
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

template <unsigned N>
bool all_zero(const Vector<N>* x, std::uint32_t count) {
  return std::all_of(x, x + count, is_zero<N>);
}

// largest deviation of the averages of K(field_level) that x starts with
template <unsigned N>
double averages_error(const Rooms<N>& rooms, const Eigen::VectorXd& averages, const std::vector<Vector<N>>& x) {
  double error = 0;
  for (Eigen::Index place = 0; place < averages.size() / N; ++place) {
    const LevelView& level = rooms.view.level[rooms.refinement.level[place]];
    for (unsigned r = 0; r < N; ++r) {
      const double value = component(x[level.node_begin + static_cast<std::size_t>(place) - level.domain_begin], r);
      error = std::max(error, std::abs(value - averages(N * place + r)));
    }
  }
  return error;
}

// what the coarser levels say of the last component of node i of a level by blocks
template <unsigned N>
float by_blocks(const ModelView& view, const LevelView& level, std::uint32_t i, const std::vector<Vector<N>>& x) {
  const PredictionsView& at = level.predictions;
  float sums[2] = {};  // of terms of even and of odd number
  for (std::size_t term = std::size_t{at.terms} * i; term < std::size_t{at.terms} * (i + 1); ++term) {
    const Vector<N> from = x[domain_node(view, stored_source(at, term))];
    float moved = 0;
    for (std::uint32_t c = 0; c < N; ++c) {
      const auto weight = static_cast<float>(stored_weight<N>(at, term, N * c + N - 1));
      moved += 65536 * weight * component(from, c);
    }
    sums[(term - std::size_t{at.terms} * i) % 2] += moved;
  }
  return 0x1p-28F * (sums[0] + sums[1]);
}

// what the coarser levels say of the last component of node i of a level
template <unsigned N>
float interpolated(const ModelView& view, const LevelView& level, std::uint32_t i, const std::vector<Vector<N>>& x) {
  if (level.predictions.weight != nullptr) {
    return by_blocks<N>(view, level, i, x);
  }
  const auto at = [&](std::uint32_t node) { return component(x[node], N - 1); };
  const std::uint32_t* parent = level.refinement[i].parent;
  float value = 0.5F * (at(parent[0]) + at(parent[1]));
  if (level.stencils != nullptr && level.stencils[i].wing[0] != layout::none) {
    const auto& [wing, outer] = level.stencils[i];
    value += 0.125F * (at(wing[0]) + at(wing[1]));
    value += -0.0625F * ((at(outer[0]) + at(outer[1])) + (at(outer[2]) + at(outer[3])));
  }
  return value;
}

TEST_CASE_TEMPLATE("a field cut off at a level keeps its averages there, interpolates beyond, leaves the scratch zero",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  const SyntheticOptions models[] = {{.levels = 5, .touchable_above = 0.5},
                                     {.levels = 4, .epsilon = 0, .quantum = 0},
                                     {.levels = 4, .wavelet = layout::Wavelet::linear},
                                     {.levels = 5, .wavelet = layout::Wavelet::lifted_butterfly},
                                     {.levels = 4, .wavelet = layout::Wavelet::butterfly, .epsilon = 0},
                                     {.levels = 5, .wavelet = layout::Wavelet::equilibrated}};
  for (SyntheticOptions options : models) {
    options.components = N;
    const ModelData data = synthetic_model(options);
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const DenseReference reference(data);
    Rooms<N> rooms(view);
    std::mt19937_64 random(8);
    for (std::uint32_t c = 0; c < view.levels; ++c) {
      for (std::uint32_t field_level = 0; field_level < view.levels; ++field_level) {
        CAPTURE(c);
        CAPTURE(field_level);
        const Forces<N> forces(view, c, random);
        std::vector<Vector<N>> x(view.node_count, Vector<N>{} + 1e30F);
        const ColumnForces columns = forces.on(c);
        rooms.touch_set({columns.count, columns.column});
        compute_field<N>(rooms.field_model(), columns, rooms.touched, {view.levels - 1, field_level},
                         rooms.field_scratch(), x.data());
        CHECK(all_zero<N>(rooms.field_sums.of_blocks, BaseColumns::width * tiles_of(view.domain_count)));
        CHECK(all_zero<3>(rooms.field_sums.of_tiles == nullptr ? nullptr : rooms.field_sums.of_tiles[0].of[0],
                          2 * N * rooms.base.tiles));
        CHECK(all_zero<N>(rooms.force, view.domain_count));
        for (std::uint32_t q = 0; q < view.levels; ++q) {
          const LevelView& level = view.level[q];
          CHECK(all_zero<N>(x.data() + level.node_begin + level.counts->domain_count,
                            level.counts->node_count - level.counts->domain_count));
          for (std::uint32_t i = 0; q > field_level && i < level.counts->domain_count; ++i) {
            CHECK(component(x[level.node_begin + i], N - 1) == interpolated<N>(view, level, i, x));
          }
        }
        std::vector<Vector<N>> coarse(nodes_up_to(view, field_level), Vector<N>{} + 1e30F);
        compute_field<N>(rooms.field_model(), columns, rooms.touched, {field_level, field_level}, rooms.field_scratch(),
                         coarse.data());
        CHECK(std::memcmp(coarse.data(), x.data(), sizeof(Vector<N>) * coarse.size()) == 0);
        const Eigen::VectorXd whole = reference.field(c) * forces.dense;
        const Eigen::VectorXd averages = reference.averages(field_level, whole);
        CHECK(averages_error<N>(rooms, averages, x) <= 1e-5 * whole.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST_CASE("forces up to the limit cannot overflow the field") {
  for (const layout::Wavelet kind : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = kind});
    const PlacedBody placed(model.view(), 5);
    Body& body = *placed.body;
    REQUIRE(body.force_limit > 1e6F);
    std::vector<Float4> x(model.view().node_count);
    for (const std::uint32_t node : model.touchable()) {
      const std::uint32_t column = make_column(3, domain_place(model.view(), node));
      const float third = body.force_limit / 3;
      const float force[] = {third, -third, third};
      clear(body.touched);
      touch(body.refinement, &column, 1, body.touched);
      compute_field<3>(body.field_model(), {1, &column, force}, body.touched, {3, 3}, body.field_scratch(), x.data());
      CHECK(std::all_of(x.begin(), x.end(),
                        [](Float4 v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }));
    }
  }
}

TEST_CASE_TEMPLATE("what is read of a body has the whole field where only a part is read", Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    const ModelData data = synthetic_model({.components = N, .levels = 4, .wavelet = kind, .read_above = 0.6});
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const DenseReference reference(data);
    Rooms<N> rooms(view);
    const TestModel read_everywhere({.components = N, .levels = 4, .wavelet = kind});
    const Rooms<N> whole(read_everywhere.view());
    std::mt19937_64 random(9);
    const Forces<N> forces(view, view.levels - 1, random);
    const ColumnForces columns = forces.on(view.levels - 1);
    rooms.touch_set({columns.count, columns.column});
    std::vector<Vector<N>> x(view.node_count);
    compute_field<N>(rooms.field_model(), columns, rooms.touched, {view.levels - 1, view.levels - 1},
                     rooms.field_scratch(), x.data());
    const Eigen::VectorXd expected = reference.field(view.levels - 1) * forces.dense;
    for (std::uint32_t place = 0; place < view.domain_count; ++place) {
      const LevelView& level = view.level[rooms.refinement.level[place]];
      const std::uint32_t i = place - level.domain_begin;
      for (unsigned r = 0; (level.nodes[i].flags & layout::node_read) != 0 && r < N; ++r) {
        CHECK(std::abs(double{component(x[level.node_begin + i], r)} - expected(Eigen::Index{N} * place + r)) <=
              1e-5 * expected.cwiseAbs().maxCoeff());
      }
    }
    CHECK(rooms.mirrored.layer[3].begin[view.domain_count] < whole.mirrored.layer[3].begin[view.domain_count]);
  }
}

TEST_CASE_TEMPLATE("forces on columns of several levels move what each of them moves", Components, One, Three) {
  constexpr unsigned N = Components::value;
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const ModelData data = synthetic_model({.components = N, .levels = 5, .wavelet = kind});
  const TestModel model(encode(data));
  const ModelView& view = model.view();
  const DenseReference reference(data);
  Rooms<N> rooms(view);
  const std::uint32_t column[] = {make_column(1, 2), make_column(1, 9), make_column(4, 1), make_column(4, 150)};
  const float force[] = {1, -2, 3, 0.5F, 4, -1, 2, 2, -3, 1, 0.25F, -2};
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(Eigen::Index{N} * view.domain_count);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::VectorXd f = Eigen::Map<const Eigen::VectorXf>(force + N * k, N).cast<double>();
    expected += reference.field(column_level(column[k])).middleCols(Eigen::Index{N} * column_place(column[k]), N) * f;
  }
  rooms.touch_set({4, column});
  std::vector<Vector<N>> x(view.node_count);
  compute_field<N>(rooms.field_model(), {4, column, force}, rooms.touched, {4, 4}, rooms.field_scratch(), x.data());
  CHECK(averages_error<N>(rooms, expected, x) <= 1e-5 * expected.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace greenloop
