#include "runtime/friction/friction.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace greenloop {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector(Float4 v) { return {v[0], v[1], v[2]}; }
Float4 stored(const Vector3d& v) {
  return Float4{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0F};
}
Block<3> block(const Matrix3d& m) {
  return {{stored(Vector3d(m.col(0))), stored(Vector3d(m.col(1))), stored(Vector3d(m.col(2)))}};
}

struct Drawn {
  explicit Drawn(unsigned seed) : random(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vector3d direction() {
    const Vector3d v(normal(random), normal(random), normal(random));
    return v.normalized();
  }
  // with a condition number of at most `condition`
  Matrix3d compliance(double condition) {
    const Vector3d a = direction();
    const Vector3d b = direction().cross(a).normalized();
    Matrix3d axes;
    axes << a, b, a.cross(b);
    const Vector3d values(1, std::pow(condition, (*this)(-1, 0)), std::pow(condition, (*this)(-1, 0)));
    return axes * values.asDiagonal() * axes.transpose();
  }
  std::mt19937 random;
  std::normal_distribution<double> normal;
};

// a bound of mu at which one contact's problem has a single solution
double safe_friction(const Matrix3d& compliance, const Vector3d& n) {
  const Vector3d by_normal = compliance * n;
  const double nn = by_normal.dot(n);
  return nn / std::max(1e-9, (by_normal - nn * n).norm());
}

TEST_CASE("one contact alone obeys the law, whether it is open, sticks or slips") {
  Drawn draw(1);
  int states[3] = {};
  for (int k = 0; k < 100000; ++k) {
    const Matrix3d compliance = draw.compliance(100);
    const Vector3d n = draw.direction();
    const double mu = k % 10 == 0 ? 0 : std::min(std::pow(10.0, draw(-4, 1)), 0.9 * safe_friction(compliance, n));
    FrictionContact contact;
    REQUIRE(set_friction_contact(stored(n), static_cast<float>(mu), block(compliance), contact));
    const Vector3d free = std::pow(10.0, draw(-6, 6)) * draw.direction();
    float multiplier = k % 3 == 0 ? 0 : static_cast<float>(draw(0, 10));
    const Float4 force = local_force(contact, stored(free), multiplier);
    const Vector3d f = vector(force);
    const Vector3d axis = vector(contact.normal);
    const double normal = f.dot(axis);
    const double friction = (f - normal * axis).norm();
    CHECK(normal >= 0);
    CHECK(friction <= double{contact.friction} * normal + (mu > 0 ? 0 : 2e-7 * normal));
    const Vector3d u = free + compliance * f;
    const Float4 residual = natural_map(contact, stored(u), force);
    CAPTURE(mu);
    CAPTURE(f.transpose());
    CHECK(vector(residual).norm() <= 1e-4 * (f.norm() + free.norm() * double{contact.scale}));
    ++states[static_cast<int>(contact_state(contact, force))];
  }
  for (const int count : states) CHECK(count > 2000);
}

TEST_CASE("what sticks is not displaced") {
  Drawn draw(2);
  for (int k = 0; k < 1000; ++k) {
    const Matrix3d compliance = draw.compliance(100);
    FrictionContact contact;
    REQUIRE(set_friction_contact(stored(draw.direction()), 1, block(compliance), contact));
    const Vector3d u = draw.direction();
    CHECK((compliance * vector(sticking_force(contact, stored(u))) - u).norm() <= 1e-4);
  }
}

TEST_CASE("projections onto the cone are the nearest forces in it") {
  Drawn draw(3);
  for (int k = 0; k < 10000; ++k) {
    FrictionContact contact;
    const double mu = draw(0, 2);
    REQUIRE(
        set_friction_contact(stored(draw.direction()), static_cast<float>(mu), block(Matrix3d::Identity()), contact));
    const Vector3d n = vector(contact.normal);
    const Vector3d f = draw.direction();
    const Vector3d p = vector(cone_projection(contact, stored(f)));
    const double normal = p.dot(n);
    CHECK((p - normal * n).norm() <= mu * normal + 1e-6);
    // p is nearest just where f - p is in the polar cone and perpendicular to p
    const Vector3d rest = f - p;
    const double along = rest.dot(n);
    CHECK(along + mu * (rest - along * n).norm() <= 1e-6);
    CHECK(std::abs(rest.dot(p)) <= 1e-6);
  }
}

TEST_CASE("however small a force is, it lies in its cone") {
  Drawn draw(4);
  const auto check = [](const FrictionContact& contact, const Vector3d& f) {
    const Vector3d n = vector(contact.normal);
    const double normal = f.dot(n);
    CHECK((f.isZero() || normal > 0));
    CHECK((f - normal * n).norm() <= (double{contact.friction} + 5e-7) * normal);
  };
  for (int k = 0; k < 10000; ++k) {
    FrictionContact contact;
    REQUIRE(set_friction_contact(stored(draw.direction()), static_cast<float>(draw(0, 1)), block(Matrix3d::Identity()),
                                 contact));
    const Vector3d f = std::pow(10, draw(-40, 0)) * draw.direction();
    check(contact, vector(force_in_cone(contact, stored(f))));
    float multiplier = 0;
    check(contact, vector(local_force(contact, stored(f), multiplier)));
  }
}

TEST_CASE("however rough a contact is, it pushes") {
  Drawn draw(5);
  for (int k = 0; k < 20000; ++k) {
    FrictionContact contact;
    const float friction = std::pow(10.0F, static_cast<float>(draw(2, 38)));
    REQUIRE(set_friction_contact(stored(draw.direction()), friction, block(Matrix3d::Identity()), contact));
    const Vector3d f = std::pow(10, draw(-9, 3)) * draw.direction();
    float multiplier = 0;
    for (const Float4 force : {force_in_cone(contact, stored(f)), local_force(contact, stored(f), multiplier)}) {
      const Vector3d pushed = vector(force), n = vector(contact.normal);
      CHECK(pushed.dot(n) >= 0);
      CHECK((pushed.norm() == 0) == (contact_state(contact, force) == ContactState::open));
    }
  }
}

TEST_CASE("compliances that are not positive definite and values that are not finite are refused") {
  const Float4 n{0, 0, 1, 0};
  FrictionContact contact;
  const Matrix3d good = Matrix3d::Identity();
  CHECK(set_friction_contact(n, 0.5F, block(good), contact));
  for (const double bad : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    for (int k = 0; k < 3; ++k) {
      Matrix3d compliance = good;
      compliance(k, k) = bad;
      CHECK_FALSE(set_friction_contact(n, 0.5F, block(compliance), contact));
    }
  }
  CHECK_FALSE(set_friction_contact(n, -0.5F, block(good), contact));
  CHECK_FALSE(set_friction_contact(n, NAN, block(good), contact));
  CHECK_FALSE(set_friction_contact(n, INFINITY, block(good), contact));
  CHECK_FALSE(set_friction_contact(Float4{NAN, 0, 1, 0}, 0.5F, block(good), contact));
}

}  // namespace
}  // namespace greenloop
