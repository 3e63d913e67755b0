#include "runtime/light.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace greenloop {
namespace {

float radiance(const float (&light)[16], const Vec3& d) {
  float harmonics[16], sum = 0;
  light_harmonics(d, harmonics);
  for (int i = 0; i < 16; ++i) sum += light[i] * harmonics[i];
  return sum;
}

TEST_CASE("harmonics are orthonormal over the sphere") {
  double gram[16][16] = {};
  constexpr int rings = 64, along = 64;
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < along; ++k) {
      const double z = (2 * i + 1.0) / rings - 1, angle = 6.283185307179586 * k / along, r = std::sqrt(1 - z * z);
      float value[16];
      light_harmonics(
          {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), static_cast<float>(z)},
          value);
      for (int a = 0; a < 16; ++a) {
        for (int b = 0; b < 16; ++b) {
          gram[a][b] +=
              12.566370614359172 / (rings * along) * static_cast<double>(value[a]) * static_cast<double>(value[b]);
        }
      }
    }
  }
  for (int a = 0; a < 16; ++a) {
    for (int b = 0; b < 16; ++b) CHECK(gram[a][b] == doctest::Approx(a == b ? 1 : 0).epsilon(0.005).scale(1));
  }
}

TEST_CASE("turned light comes from the turned direction, and turned back it is what it was") {
  const float c = std::cos(0.7F), s = std::sin(0.7F), e = std::cos(-1.9F), f = std::sin(-1.9F);
  const float turn[9] = {c, -s, 0, e * s, e * c, -f, f * s, f * c, e};  // about z, then about x
  const float back[9] = {turn[0], turn[3], turn[6], turn[1], turn[4], turn[7], turn[2], turn[5], turn[8]};
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  Light light;
  for (int i = 0; i < 16; ++i) {
    light.red[i] = normal(random);
    light.green[i] = normal(random);
    light.blue[i] = normal(random);
  }
  const Light turned = rotated(light, turn), again = rotated(turned, back);
  for (int k = 0; k < 50; ++k) {
    Vec3 d = {normal(random), normal(random), normal(random)};
    const float length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    d = {d.x / length, d.y / length, d.z / length};
    const Vec3 there = {turn[0] * d.x + turn[1] * d.y + turn[2] * d.z, turn[3] * d.x + turn[4] * d.y + turn[5] * d.z,
                        turn[6] * d.x + turn[7] * d.y + turn[8] * d.z};
    CHECK(radiance(turned.red, there) == doctest::Approx(radiance(light.red, d)).epsilon(1e-5).scale(1));
    CHECK(radiance(turned.blue, there) == doctest::Approx(radiance(light.blue, d)).epsilon(1e-5).scale(1));
  }
  for (int i = 0; i < 16; ++i) CHECK(again.green[i] == doctest::Approx(light.green[i]).epsilon(1e-5).scale(1));
}

}  // namespace
}  // namespace greenloop
