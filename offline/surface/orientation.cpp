#include "offline/surface/orientation.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>

namespace greenloop::offline {
namespace {

struct Sum {
  double value;
  double error;
};

Sum exact_sum(double a, double b) {
  const double value = a + b;
  const double b_part = value - a;
  return {value, (a - (value - b_part)) + (b - b_part)};
}

Sum exact_product(double a, double b) {
  const double value = a * b;
  return {value, std::fma(a, b, -value)};
}

/// A number held as a sum of doubles that do not overlap, smallest first; no operation rounds.
template <std::size_t capacity>
class Expansion {
 public:
  void add(double term) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const auto [value, error] = exact_sum(term, terms_[i]);
      term = value;
      if (error != 0) {
        terms_[kept++] = error;
      }
    }
    if (term != 0) {
      terms_[kept++] = term;
    }
    size_ = kept;
  }

  void add_product(double a, double b) {
    const auto [value, error] = exact_product(a, b);
    add(error);
    add(value);
  }

  void add_product(double a, double b, double c) {
    const auto [value, error] = exact_product(a, b);
    add_product(error, c);
    add_product(value, c);
  }

  /// Of the largest term, which outweighs all others together.
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : terms_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, capacity> terms_;
  std::size_t size_ = 0;
};

int exact_orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  Expansion<12> determinant;
  const std::array<const Eigen::Vector2d*, 3> p{&a, &b, &c};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& u = *p[i];
    const auto& v = *p[(i + 1) % 3];
    determinant.add_product(u.x(), v.y());
    determinant.add_product(-u.y(), v.x());
  }
  return determinant.sign();
}

/// Adds sign * det[u, v, w].
void add_determinant(Expansion<96>& sum, double sign, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                     const Eigen::Vector3d& w) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    sum.add_product(sign * u[i], v[j], w[k]);
    sum.add_product(-sign * u[i], v[k], w[j]);
  }
}

int exact_orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  Expansion<96> determinant;
  add_determinant(determinant, 1, b, c, d);
  add_determinant(determinant, -1, a, c, d);
  add_determinant(determinant, 1, a, b, d);
  add_determinant(determinant, -1, a, b, c);
  return determinant.sign();
}

int sign(double value) { return value > 0 ? 1 : -1; }

// Bounds of the rounding error in units of the sum of absolute products, with room to spare.
constexpr double filter_2d = 8 * 1.1102230246251565e-16;
constexpr double filter_3d = 16 * 1.1102230246251565e-16;

}  // namespace

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (b.x() - a.x()) * (c.y() - a.y());
  const double right = (b.y() - a.y()) * (c.x() - a.x());
  const double determinant = left - right;
  if (std::abs(determinant) > filter_2d * (std::abs(left) + std::abs(right))) {
    return sign(determinant);
  }
  return exact_orientation(a, b, c);
}

int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Eigen::Vector3d& d) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d v = c - a;
  const Eigen::Vector3d w = d - a;
  const double determinant = u.dot(v.cross(w));
  const auto permanent = [&](int i, int j, int k) {
    return std::abs(u[i]) * (std::abs(v[j] * w[k]) + std::abs(v[k] * w[j]));
  };
  if (std::abs(determinant) > filter_3d * (permanent(0, 1, 2) + permanent(1, 2, 0) + permanent(2, 0, 1))) {
    return sign(determinant);
  }
  return exact_orientation(a, b, c, d);
}

}  // namespace greenloop::offline
