#include "runtime/mask.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "runtime/surface.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// a model, its surface and room for a mask
struct Bench {
  explicit Bench(const SyntheticOptions& options)
      : model(options),
        finest(model.view().levels - 1),
        memory(Surface::required(model.model(), finest).bytes),
        node(model.view().node_count),
        weight(node.size()) {
    const auto created = Surface::create(model.model(), finest, {memory.data(), memory.size()});
    REQUIRE(created);
    surface = created.surface;
  }
  Mask make(const MeshPoint& point, float radius) { return make_mask(surface, finest, point, radius, node, weight); }
  [[nodiscard]] double distance(std::uint32_t a, std::uint32_t b) const {
    const Vec3 x = model.model().position(a), y = model.model().position(b);
    return std::hypot(double{x.x} - y.x, double{x.y} - y.y, double{x.z} - y.z);
  }
  TestModel model;
  std::uint32_t finest;
  AlignedBytes memory;
  Surface surface;
  std::vector<std::uint32_t> node;
  std::vector<float> weight;
};

double sum(std::span<const float> weight) { return std::accumulate(weight.begin(), weight.end(), 0.0); }

// by its definition with many parts of each triangle, [nodes]
std::vector<double> vertex_mask(const Bench& bench, std::uint32_t centre, double radius) {
  constexpr int parts = 40;
  std::vector<double> part(bench.node.size());
  const Vec3 c = bench.model.model().position(centre);
  for (std::uint32_t t = 0; t < bench.surface.triangle_count(bench.finest); ++t) {
    const Surface::Triangle triangle = bench.surface.triangle(bench.finest, t);
    Vec3 x[3];
    for (std::size_t k = 0; k < 3; ++k) x[k] = bench.model.model().position(triangle.node[k]);
    const Vec3 a{x[1].x - x[0].x, x[1].y - x[0].y, x[1].z - x[0].z};
    const Vec3 b{x[2].x - x[0].x, x[2].y - x[0].y, x[2].z - x[0].z};
    const double area = std::hypot(double{a.y} * b.z - double{a.z} * b.y, double{a.z} * b.x - double{a.x} * b.z,
                                   double{a.x} * b.y - double{a.y} * b.x);
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        const double v = (i + 1.0 / 3) / parts, w = (j + 1.0 / 3) / parts, u = 1 - v - w;
        const double away =
            std::hypot(u * x[0].x + v * x[1].x + w * x[2].x - c.x, u * x[0].y + v * x[1].y + w * x[2].y - c.y,
                       u * x[0].z + v * x[1].z + w * x[2].z - c.z);
        const double rho = std::max(0.0, 1 - away / radius) * area;
        const double of[3] = {u * rho, v * rho, w * rho};
        for (std::size_t k = 0; k < 3; ++k) {
          if (bench.model.model().is_touchable(triangle.node[k])) part[triangle.node[k]] += of[k];
        }
      }
    }
  }
  const double all = std::accumulate(part.begin(), part.end(), 0.0);
  for (double& of_node : part) of_node /= all;
  return part;
}

// the largest difference of weights, of the largest
double difference(const Mask& mask, std::vector<double> exact) {
  const double largest = *std::max_element(exact.begin(), exact.end());
  for (std::size_t k = 0; k < mask.node.size(); ++k) exact[mask.node[k]] -= double{mask.weight[k]};
  double worst = 0;
  for (const double one : exact) worst = std::max(worst, std::abs(one));
  return worst / largest;
}

TEST_CASE("a mask is the linear profile's integral with each node's function, normalised, on touchable nodes alone") {
  Bench bench({.levels = 5});
  const std::uint32_t centre = bench.model.touchable()[40];
  const double far = bench.distance(centre, bench.model.touchable()[0]);
  for (const double share : {0.2, 0.4, 0.8}) {
    const Mask mask = bench.make(at_node(centre), static_cast<float>(share * far));
    REQUIRE(mask.node.size() > 6);
    CHECK(difference(mask, vertex_mask(bench, centre, share * far)) < 0.03);
    CHECK(sum(mask.weight) == doctest::Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("the mask of a point is the mean of its corners' by their weights") {
  Bench bench({.levels = 4});
  const std::vector<std::uint32_t> nodes = bench.model.touchable();
  const MeshPoint point{{nodes[3], nodes[17], nodes[29]}, {0.5F, 0.3F, 0.2F}};
  const double radius = 1.1 * bench.distance(nodes[3], nodes[17]);
  const Mask mask = bench.make(point, static_cast<float>(radius));
  std::vector<double> exact(bench.node.size());
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> corner = vertex_mask(bench, point.node[k], radius);
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i] += double{point.weight[k]} * corner[i];
  }
  CHECK(difference(mask, exact) < 0.03);
}

TEST_CASE("below the node spacing a mask is its node; corners that are not touchable take their share away") {
  Bench bench({.levels = 4});
  const std::uint32_t node = bench.model.touchable()[5];
  const Mask single = bench.make(at_node(node), 1e-6F);
  REQUIRE(single.node.size() == 1);
  CHECK(single.node[0] == node);
  CHECK(single.weight[0] == 1);
  std::uint32_t fixed = 0;
  while (bench.model.model().is_touchable(fixed)) ++fixed;
  CHECK(sum(bench.make({{node, fixed, node}, {0.5F, 0.25F, 0.25F}}, 0.01F).weight) == doctest::Approx(0.75));
  CHECK(bench.make(at_node(fixed), 0.01F).node.empty());
}

TEST_CASE("a mask along a direction has its weights, a torque turns by a newton metre and does not push") {
  Bench bench({.levels = 4});
  const Mask mask = bench.make(at_node(bench.model.touchable()[40]), 0.05F);
  REQUIRE(mask.node.size() > 3);
  std::vector<Vec3> part(mask.node.size());
  const DirectedMask along = direct_mask(mask, {0, 0.6F, 0.8F}, part);
  REQUIRE(along.part.size() == mask.node.size());
  for (std::size_t k = 0; k < part.size(); ++k) {
    CHECK(along.part[k].x == 0);
    CHECK(along.part[k].y == mask.weight[k] * 0.6F);
    CHECK(along.part[k].z == mask.weight[k] * 0.8F);
  }
  const DirectedMask torque = make_torque_mask(bench.model.model(), mask, {0, 0, 1}, part);
  REQUIRE(torque.part.size() == mask.node.size());
  double force[3] = {}, about = 0, size = 0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const Vec3 x = bench.model.model().position(mask.node[k]);
    force[0] += double{part[k].x};
    force[1] += double{part[k].y};
    force[2] += double{part[k].z};
    about += double{x.x} * part[k].y - double{x.y} * part[k].x;
    size += std::hypot(double{part[k].x}, double{part[k].y});
  }
  CHECK(about == doctest::Approx(1).epsilon(1e-4));
  for (const double sum : force) CHECK(std::abs(sum) <= 1e-4 * size);
  // what is no such mask
  CHECK(direct_mask(mask, {0, 0, 1}, std::span(part).first(2)).node.empty());
  CHECK(make_torque_mask(bench.model.model(), mask, {0, 0, 1}, std::span(part).first(2)).node.empty());
  CHECK(
      make_torque_mask(bench.model.model(), {mask.node.first(1), mask.weight.first(1)}, {0, 0, 1}, part).node.empty());
  const std::uint32_t foreign[] = {bench.model.view().node_count, 0};
  const float halves[] = {0.5F, 0.5F};
  CHECK(make_torque_mask(bench.model.model(), {foreign, halves}, {0, 0, 1}, part).node.empty());
}

TEST_CASE("what is no mask is an empty one") {
  Bench bench({.levels = 3});
  const std::uint32_t node = bench.model.touchable()[0];
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float radius : {0.0F, -1.0F, nan, infinity}) CHECK(bench.make(at_node(node), radius).node.empty());
  CHECK(bench.make(at_node(bench.model.view().node_count), 1).node.empty());
  CHECK(bench.make({{node, node, node}, {nan, 0, 0}}, 1).node.empty());
  CHECK(make_mask(bench.surface, bench.finest, at_node(node), 1, std::span(bench.node).first(3), bench.weight)
            .node.empty());
  CHECK(make_mask(bench.surface, bench.finest + 1, at_node(node), 1, bench.node, bench.weight).node.empty());
  CHECK_FALSE(bench.make(at_node(node), 1).node.empty());
}

}  // namespace
}  // namespace greenloop
