#include "runtime/factor/factor.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "formats/testing/dense_wavelet.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::uint32_t most = 20;

// the model, what is made of it and its dense compliance between the averages of the finest level
template <unsigned N>
struct Made {
  explicit Made(layout::Wavelet kind) : Made(synthetic_model({.components = N, .levels = 4, .wavelet = kind})) {}
  explicit Made(const ModelData& data)
      : model(encode(data)),
        rooms(model.view(), most, true),
        exact(decoded_compliance(data, model.view().levels - 1)) {}

  // touchable nodes as columns of the finest level
  [[nodiscard]] std::vector<std::uint32_t> columns(std::size_t first, std::size_t count) const {
    const std::vector<std::uint32_t> nodes = model.touchable();
    std::vector<std::uint32_t> places;
    for (std::size_t i = first; i < first + count; ++i) places.push_back(domain_place(model.view(), nodes[i]));
    return columns_at(model.view().levels - 1, places);
  }

  // between the nodes of a factor, in their order
  [[nodiscard]] MatrixXd between(const Factor& factor) const {
    MatrixXd matrix(Index{N} * factor.columns, Index{N} * factor.columns);
    for (std::uint32_t i = 0; i < factor.columns; ++i) {
      for (std::uint32_t j = 0; j < factor.columns; ++j) {
        matrix.block<N, N>(Index{N} * i, Index{N} * j) =
            exact.block<N, N>(Index{N} * column_place(factor.node[i]), Index{N} * column_place(factor.node[j]));
      }
    }
    return matrix;
  }

  // solves with the factor, and looks at what is kept beside it
  void check(const Factor& factor, ColumnSet set) const {
    for (std::uint32_t k = 0; k < set.count; ++k) CHECK(factor.node[factor.position[k]] == set.column[k]);
    const MatrixXd a = between(factor);
    const auto order = static_cast<std::uint32_t>(a.rows());
    const std::uint32_t stride = rooms.cache.stride();
    std::vector<Float4> b(padded_order(order) / 4);
    auto* const x = reinterpret_cast<float*>(b.data());
    for (std::uint32_t i = 0; i < order; ++i) x[i] = 1;
    cholesky_solve(order, stride, factor.matrix, b.data());
    const Eigen::VectorXd solution = Eigen::Map<const Eigen::VectorXf>(x, order).cast<double>();
    const double scale = a.cwiseAbs().rowwise().sum().maxCoeff() * solution.cwiseAbs().maxCoeff();
    CHECK((a * solution - Eigen::VectorXd::Ones(order)).cwiseAbs().maxCoeff() <= 2e-6 * scale);
    for (std::uint32_t j = 0; j < order; ++j) {
      for (std::uint32_t i = j; i < order; ++i) {
        const double kept = factor.capacitance[std::size_t{stride} * j + i];
        CHECK(std::abs(kept - a(i, j)) <= 2e-6 * a.cwiseAbs().maxCoeff());
      }
    }
  }

  TestModel model;
  Rooms<N> rooms;
  MatrixXd exact;
};

TEST_CASE_TEMPLATE("factors made afresh, changed and made in slices are those of the dense compliance", Components, One,
                   Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    Made<N> made(kind);
    Rooms<N>& rooms = made.rooms;
    const std::vector<std::uint32_t> first = made.columns(0, 17);
    ColumnSet set{17, first.data()};
    rooms.touch_set(set);
    Factor* factor = make_factor<N>(rooms.factor_tools(), set, rooms.touched, nullptr);
    REQUIRE(factor != nullptr);
    rooms.cache.keep(*factor, set);
    made.check(*factor, set);
    // three nodes leave, five enter
    const std::vector<std::uint32_t> next = made.columns(3, 19);
    set = {19, next.data()};
    rooms.touch_set(set);
    FactorChanges changes;
    find_changes(rooms.cache, set, changes);
    REQUIRE(changes.base == factor);
    CHECK(changes.added == 5);
    CHECK(changes.removed == 3);
    factor = make_factor<N>(rooms.factor_tools(), set, rooms.touched, &changes);
    REQUIRE(factor != nullptr);
    rooms.cache.keep(*factor, set);
    CHECK(factor->changes == 8);
    made.check(*factor, set);
    // nothing of it is made yet
    const std::vector<std::uint32_t> last = made.columns(40, most);
    set = {most, last.data()};
    const SetCounts whole = rooms.touch_set(set);
    const std::uint64_t allowance = pending_work(rooms.counts, whole) / 4;
    int slices = 1;
    while (continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance}).pending > 0) {
      REQUIRE(++slices < 20);
    }
    CHECK(slices > 1);
    REQUIRE(rooms.cache.find(set) != nullptr);
    made.check(*rooms.cache.find(set), set);
  }
}

}  // namespace
}  // namespace greenloop
