#include "offline/compress/testing/thin_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline::test {
namespace {

template <class Move>
SemiRegularMesh moved(SemiRegularMesh mesh, const Move& move) {
  for (auto& position : mesh.positions) position = move(position);
  return mesh;
}

// from 0 to 1 between `begin` and `end`
double blend(double x, double begin, double end) {
  const double t = std::clamp((x - begin) / (end - begin), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// a coordinate of the unit sphere pressed to a plate of this thickness with a round edge
double plate(double x, double thickness) { return 0.5 * thickness * std::tanh(4 * x); }

}  // namespace

SemiRegularMesh ear(int levels) {
  return moved(icosphere(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const double drawn = blend(x.z(), -0.1, 0.3);  // nothing below, a blade above
    return {std::lerp(x.x(), plate(x.x(), 0.16), drawn), x.y() * (1 - 0.4 * drawn), x.z() < 0 ? x.z() : 2.2 * x.z()};
  });
}

SemiRegularMesh bowl(int levels) {
  return moved(icosphere(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return {x.x(), x.y(), plate(x.z(), 0.08) + 0.3 * (x.x() * x.x() + x.y() * x.y())};
  });
}

SemiRegularMesh handle(int levels) {
  return moved(torus(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const Eigen::Vector3d ring = Eigen::Vector3d(x.x(), x.y(), 0).normalized();
    const Eigen::Vector3d tube = (x - ring) / torus_tube;  // a unit vector across the ring
    const double body = blend(-ring.x(), 0.0, 0.8);
    const double out = tube.dot(ring) * std::lerp(0.08, 0.7, body), up = tube.z() * std::lerp(0.2, 0.7, body);
    return {(1 + out) * ring.x(), up, -(1 + out) * ring.y()};
  });
}

SemiRegularMesh web(int levels) {
  return moved(icosphere(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const double thick = blend(std::abs(x.x()), 0.5, 0.75);
    return {x.x(), 0.6 * x.y(), std::lerp(plate(x.z(), 0.06), 0.35 * x.z(), thick)};
  });
}

}  // namespace greenloop::offline::test
