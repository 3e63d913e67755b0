#include "runtime/stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace greenloop {

bool invert_compliance(std::span<const float, 9> compliance, std::span<float, 9> stiffness) noexcept {
  const auto at = [&](std::size_t r, std::size_t c) { return double{compliance[3 * (c % 3) + r % 3]}; };
  const auto cofactor = [&](std::size_t r, std::size_t c) {
    return at(r + 1, c + 1) * at(r + 2, c + 2) - at(r + 1, c + 2) * at(r + 2, c + 1);
  };
  const double determinant = at(0, 0) * cofactor(0, 0) + at(0, 1) * cofactor(0, 1) + at(0, 2) * cofactor(0, 2);
  float inverse[9];
  bool finite = true;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      inverse[3 * c + r] = static_cast<float>(cofactor(c, r) / determinant);
      finite = finite && std::isfinite(inverse[3 * c + r]);
    }
  }
  if (finite) {
    std::copy_n(inverse, 9, stiffness.begin());
  }
  return finite;
}

void write_rigid_stiffness(float along, std::span<float, 9> stiffness) noexcept {
  for (std::size_t k = 0; k < 9; ++k) {
    stiffness[k] = k % 4 == 0 ? along : 0;
  }
}

float stiffness_norm(std::span<const float, 9> stiffness) noexcept {
  double sum = 0;
  for (const float value : stiffness) {
    sum += double{value} * double{value};
  }
  return static_cast<float>(std::sqrt(sum));
}

void cap_stiffness(float rigid, std::span<float, 9> stiffness) noexcept {
  float of_rigid[9];
  write_rigid_stiffness(rigid, of_rigid);
  const float eta = std::min(1.0F, stiffness_norm(of_rigid) / stiffness_norm(stiffness));
  for (float& value : stiffness) {
    value *= eta;
  }
}

}  // namespace greenloop
