#include "runtime/wavelet/force_transform.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {
namespace {

// coefficients of nodal forces of level c, by T_l^-T as dense matrices
std::vector<double> dense_coefficients(const ModelView& view, const std::vector<Eigen::SparseMatrix<double>>& inverse,
                                       std::uint32_t c, Eigen::VectorXd f) {
  std::vector<double> result(std::size_t{view.info->components} * view.domain_count);
  for (std::uint32_t level = c; level > 0; --level) {
    f.head(inverse[level].rows()) = Eigen::VectorXd(inverse[level].transpose() * f.head(inverse[level].rows()));
  }
  std::copy(f.begin(), f.end(), result.begin());
  return result;
}

TEST_CASE_TEMPLATE("sparse forces reach the coefficients that the dense transform finds, and no other", Components, One,
                   Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    const TestModel model({.components = N, .levels = 5, .wavelet = kind, .touchable_above = 0.8});
    const ModelView& view = model.view();
    Rooms<N> rooms(view);
    LiftingCounts lifting[layout::max_levels] = {};
    std::vector<Eigen::SparseMatrix<double>> inverse(view.levels);
    for (std::uint32_t q = 1; q < view.levels; ++q) {
      inverse[q] = inverse_step(view, q);
      lifting[q] = count_lifting(view, q);
      // an octahedron's corners have four edges
      CHECK(lifting[q].most_neighbours == (!layout::is_lifted(kind) ? 0 : q == 1 ? 4 : 6));
    }
    std::mt19937_64 random(3);
    for (std::uint32_t c = 0; c < view.levels; ++c) {
      const ReachBound reach = bound_reach(view, c, lifting);
      REQUIRE(reach.bounded);
      for (int trial = 0; trial < 30; ++trial) {
        std::vector<std::uint32_t> places(domain_up_to(view, c));
        for (std::uint32_t i = 0; i < places.size(); ++i) {
          places[i] = i;
        }
        std::shuffle(places.begin(), places.end(), random);
        places.resize(std::min<std::size_t>(places.size(), trial < 15 ? 1 : 16));
        Eigen::VectorXd f = Eigen::VectorXd::Zero(N * domain_up_to(view, c));
        std::vector<std::uint32_t> columns;
        std::vector<float> forces;
        for (const std::uint32_t place : places) {
          columns.push_back(make_column(c, place));
        }
        touch(rooms.refinement, columns.data(), static_cast<std::uint32_t>(columns.size()), rooms.touched);
        for (const std::uint32_t place : places) {
          for (Eigen::Index r = 0; r < N; ++r) {
            forces.push_back(static_cast<float>(random() >> 40) * 0x1p-24F);
            f(Eigen::Index{N} * place + r) = forces.back();
          }
        }
        transform_forces<N>(rooms.refinement,
                            {static_cast<std::uint32_t>(columns.size()), columns.data(), forces.data()}, rooms.touched,
                            rooms.force);
        const auto dense = dense_coefficients(view, inverse, c, f);
        std::vector<int> times(view.domain_count);
        for (std::uint32_t q = 0; q < view.levels; ++q) {
          const LevelView& level = view.level[q];
          for (std::uint32_t k = 0; k < rooms.touched.count[q]; ++k) {
            CHECK(rooms.touched.list[q][k] - level.domain_begin < level.counts->domain_count);
            ++times[rooms.touched.list[q][k]];
          }
          CHECK(rooms.touched.count[q] <= (q <= c ? places.size() * reach.coefficients[q] : 0));
        }
        for (std::size_t i = 0; i < dense.size(); ++i) {
          CHECK(times[i / N] <= 1);
          CHECK(std::abs(double{component(rooms.force[i / N], i % N)} - dense[i]) <= 1e-5);
          CHECK((times[i / N] == 1 || dense[i] == 0));
          CHECK(is_padded(rooms.force[i / N]));
        }
        clear_forces<N>(rooms.touched, rooms.force);
        clear(rooms.touched);
        CHECK(std::none_of(rooms.touched.mark, rooms.touched.mark + view.domain_count, [](bool m) { return m; }));
        CHECK(std::all_of(rooms.force, rooms.force + view.domain_count, is_zero<N>));
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
