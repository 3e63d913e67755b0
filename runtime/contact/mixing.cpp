#include "runtime/contact/mixing.hpp"

#include <cfloat>

namespace greenloop {
namespace {

constexpr double ridge = 0x1p-40;  // of a diagonal entry

double dot(const Float4* a, const Float4* b, std::uint32_t length) {
  double sum[4] = {};
  for (std::uint32_t i = 0; i < length; ++i)
    for (int k = 0; k < 4; ++k) sum[k] += (double)a[i][k] * b[i][k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

void Mixing::carve(Arena& arena, std::uint32_t length) noexcept {
  for (std::uint32_t k = 0; k < depth; ++k) {
    change_[k] = arena.take<Float4>(length);
    deviation_[k] = arena.take<Float4>(length);
  }
  last_ = arena.take<Float4>(length);
  last_step_ = arena.take<Float4>(length);
}

void Mixing::begin(std::uint32_t length) noexcept {
  length_ = length;
  seen_ = 0;
}

// the changes since the last call, in place of the oldest
void Mixing::remember(const Float4* y, const Float4* x) noexcept {
  if (seen_ > 0) {
    const std::uint32_t slot = (seen_ - 1) % depth;
    for (std::uint32_t i = 0; i < length_; ++i) {
      change_[slot][i] = y[i] - last_[i];
      deviation_[slot][i] = (y[i] - x[i]) - last_step_[i];
    }
    const std::uint32_t known = seen_ < depth ? seen_ : depth;
    for (std::uint32_t k = 0; k < known; ++k) {
      product_[slot][k] = product_[k][slot] = dot(deviation_[slot], deviation_[k], length_);
    }
  }
  for (std::uint32_t i = 0; i < length_; ++i) {
    last_[i] = y[i];
    last_step_[i] = y[i] - x[i];
  }
  ++seen_;
}

// of the deviations against the last step, by Cholesky's factors of the normal equations; returns their number
std::uint32_t Mixing::least_squares(double (&weight)[depth]) noexcept {
  const std::uint32_t known = seen_ - 1 < depth ? seen_ - 1 : depth;
  double factor[depth][depth];
  for (std::uint32_t k = 0; k < known; ++k) {
    weight[k] = dot(deviation_[k], last_step_, length_);
    for (std::uint32_t j = 0; j <= k; ++j) {
      double sum = j == k ? product_[k][k] * (1 + ridge) : product_[k][j];
      for (std::uint32_t i = 0; i < j; ++i) {
        sum -= factor[k][i] * factor[j][i] * factor[i][i];
      }
      factor[k][j] = j == k ? sum : sum / factor[j][j];
    }
    if (!(factor[k][k] > 0 && factor[k][k] <= FLT_MAX)) {
      return 0;
    }
    for (std::uint32_t j = 0; j < k; ++j) {
      weight[k] -= factor[k][j] * weight[j];
    }
  }
  for (std::uint32_t k = known; k-- > 0;) {
    weight[k] /= factor[k][k];
    for (std::uint32_t j = k + 1; j < known; ++j) {
      weight[k] -= factor[j][k] * weight[j];
    }
  }
  return known;
}

void Mixing::mix(const Float4* y, Float4* x) noexcept {
  remember(y, x);
  double weight[depth];
  const std::uint32_t known = least_squares(weight);
  for (std::uint32_t i = 0; i < length_; ++i) {
    Float4 next = y[i];
    for (std::uint32_t k = 0; k < known; ++k) {
      next -= splat((float)weight[k]) * change_[k][i];
    }
    x[i] = next;
  }
}

}  // namespace greenloop
