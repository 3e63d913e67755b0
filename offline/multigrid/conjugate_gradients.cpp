#include "offline/multigrid/conjugate_gradients.hpp"

#include <cmath>

namespace greenloop::offline {
namespace {

double norm(std::span<const Double4> v) { return std::sqrt(dot(v, v)); }

void add_scaled(std::span<Double4> sum, double scale, std::span<const Double4> v) {
  const auto s = splat(scale);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += s * v[i];
}

/// direction = z + beta direction
void turn(std::span<Double4> direction, double beta, std::span<const Double4> z) {
  const auto s = splat(beta);
  for (std::size_t i = 0; i < z.size(); ++i) direction[i] = z[i] + s * direction[i];
}

}  // namespace

Convergence conjugate_gradients(const BlockMatrix& matrix, const Preconditioner& precondition,
                                std::span<const Double4> b, std::span<Double4> x, double tolerance,
                                int most_iterations) {
  const std::size_t n = b.size();
  const double size = norm(b);
  if (size == 0.0) {
    for (auto& value : x) value = Double4{};
    return {0.0, 0, true};
  }
  BlockVector r(n), z(n), direction(n), image(n);
  Convergence state{0.0, 0, false};
  for (double before = 0.0;;) {
    residual(matrix, b, x, r);
    const double now = norm(r);
    state.residual = now / size;
    state.reached = state.residual <= tolerance;
    const bool falls = state.iterations == 0 || now < 0.5 * before;
    if (state.reached || state.iterations >= most_iterations || !falls || !std::isfinite(now)) return state;
    before = now;
    precondition(r, z);
    direction = z;
    double rz = dot(r, z);
    while (state.iterations < most_iterations) {
      const double step = rz / multiply(matrix, direction, image);
      add_scaled(x, step, direction);
      add_scaled(r, -step, image);
      ++state.iterations;
      if (!(norm(r) > tolerance * size) || !std::isfinite(step)) break;
      precondition(r, z);
      // (r_new - r_old) . z = -step image . z
      const double beta = -step * dot(image, z) / rz;
      rz = dot(r, z);
      turn(direction, beta, z);
    }
  }
}

}  // namespace greenloop::offline
