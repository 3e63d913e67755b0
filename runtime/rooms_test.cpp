// From a model file through capacitance matrix, factor, forces and field to what dense matrices answer, by the rooms of
// the runtime alone: for models that have no solver too.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <vector>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// float rounding of the matrix, the factors and the sums, amplified by the condition
double tolerance_of(const MatrixXd& a) {
  const VectorXd values = Eigen::JacobiSVD<MatrixXd>(a).singularValues();
  return 60 * values.maxCoeff() / values.minCoeff() * 0x1p-24;
}

// values that differ, as float has them
VectorXd prescribed(Index count) {
  VectorXd values(count);
  for (Index i = 0; i < count; ++i) values(i) = double{1e-4F * static_cast<float>(1 + i % 7) - 3e-4F};
  return values;
}

// what holds the set at those
template <unsigned N>
std::vector<float> solve(Rooms<N>& rooms, ColumnSet set, const VectorXd& held) {
  const Factor* const factor = make_factor<N>(rooms.factor_tools(), set, rooms.touched, nullptr);
  REQUIRE(factor != nullptr);
  const std::uint32_t order = N * set.count;
  std::vector<Float4> b(padded_order(order) / 4);
  auto* const x = reinterpret_cast<float*>(b.data());
  for (std::uint32_t i = 0; i < order; ++i) x[i] = static_cast<float>(held(i));
  cholesky_solve(order, rooms.cache.stride(), factor->matrix, b.data());
  return {x, x + order};
}

template <unsigned N>
void check_answer(Rooms<N>& rooms, const DenseReference& reference, std::uint32_t c, std::uint32_t count) {
  const ModelView& view = rooms.view;
  std::vector<std::uint32_t> places;
  for (std::uint32_t k = 0; k < count; ++k) places.push_back(k * domain_up_to(view, c) / count);
  const std::vector<std::uint32_t> columns = columns_at(c, places);
  const ColumnSet set{count, columns.data()};
  MatrixXd a(Index{N} * count, Index{N} * count);
  MatrixXd used(Index{N} * view.domain_count, Index{N} * count);
  for (std::uint32_t j = 0; j < count; ++j) {
    used.middleCols<N>(Index{N} * j) = reference.field(c).middleCols<N>(Index{N} * places[j]);
    for (std::uint32_t i = 0; i < count; ++i) {
      a.block<N, N>(Index{N} * i, Index{N} * j) =
          reference.compliance(c).block<N, N>(Index{N} * places[i], Index{N} * places[j]);
    }
  }
  const VectorXd held = prescribed(a.rows());
  const VectorXd force = a.fullPivLu().solve(held);
  const VectorXd field = used * force;
  rooms.touch_set(set);
  const std::vector<float> found = solve<N>(rooms, set, held);
  const double tolerance = tolerance_of(a);
  CHECK(tolerance < 0.002);  // or what follows would say little
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(std::abs(double{found[i]} - force(static_cast<Index>(i))) <= tolerance * force.cwiseAbs().maxCoeff());
  }
  std::vector<Vector<N>> x(view.node_count);
  compute_field<N>(rooms.field_model(), {count, columns.data(), found.data()}, rooms.touched,
                   {view.levels - 1, view.levels - 1}, rooms.field_scratch(), x.data());
  for (std::uint32_t place = 0; place < view.domain_count; ++place) {
    for (unsigned r = 0; r < N; ++r) {
      const double value = component(x[domain_node(view, place)], r);
      CHECK(std::abs(value - field(Index{N} * place + r)) <= tolerance * field.cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE_TEMPLATE("from a model file through capacitance, factor, forces and field to the dense answer", Components,
                   One, Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    const ModelData data = synthetic_model({.components = N, .levels = 5, .wavelet = kind, .epsilon = 0.002});
    const TestModel model(encode(data));
    const DenseReference reference(data);
    Rooms<N> rooms(model.view(), 24);
    for (std::uint32_t c = 0; c < model.view().levels; ++c) {
      CAPTURE(c);
      check_answer<N>(rooms, reference, c, std::min(24U, domain_up_to(model.view(), c)));
    }
  }
}

}  // namespace
}  // namespace greenloop
