#include "runtime/light.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t n = Light::coefficients;

// Lebedev's rule of 26 points on the sphere, exact to degree 7: of two harmonics to degree 6.
constexpr std::uint32_t points = 26;
constexpr float four_pi = 12.566370614359172F;

struct Point {
  Vec3 direction;
  float weight;
};

// the 26 neighbours of a cell in a grid of cubes
Point rule_point(std::uint32_t k) {
  const std::uint32_t cell = k < points / 2 ? k : k + 1;  // of 27, but for the middle one
  const auto step = [](std::uint32_t x) { return static_cast<float>(x) - 1; };
  const Vec3 d = {step(cell % 3), step(cell / 3 % 3), step(cell / 9)};
  constexpr float length[] = {1, 0.70710678F, 0.57735027F};  // 1 over it
  constexpr float weight[] = {four_pi / 21, four_pi * 4 / 105, four_pi * 9 / 280};
  const auto kind = static_cast<std::uint32_t>(d.x * d.x + d.y * d.y + d.z * d.z) - 1;  // 0: a face, an edge, a corner
  return {{d.x * length[kind], d.y * length[kind], d.z * length[kind]}, weight[kind]};
}

void project(const float (&light)[n], const float (&from)[n], const float (&to)[n], float weight, float (&sum)[n]) {
  float radiance = 0;
  for (std::uint32_t i = 0; i < n; ++i) radiance += light[i] * from[i];
  for (std::uint32_t i = 0; i < n; ++i) sum[i] += weight * radiance * to[i];
}

}  // namespace

void light_harmonics(const Vec3& direction, float (&value)[n]) noexcept {
  const float x = direction.x, y = direction.y, z = direction.z;
  const float xx = x * x, yy = y * y, zz = z * z;
  value[0] = 0.28209479F;
  value[1] = 0.48860251F * y;
  value[2] = 0.48860251F * z;
  value[3] = 0.48860251F * x;
  value[4] = 1.09254843F * (x * y);
  value[5] = 1.09254843F * (y * z);
  value[6] = 0.31539157F * (3 * zz - 1);
  value[7] = 1.09254843F * (x * z);
  value[8] = 0.54627422F * (xx - yy);
  value[9] = 0.59004359F * (y * (3 * xx - yy));
  value[10] = 2.89061144F * (x * y * z);
  value[11] = 0.45704579F * (y * (5 * zz - 1));
  value[12] = 0.37317633F * (z * (5 * zz - 3));
  value[13] = 0.45704579F * (x * (5 * zz - 1));
  value[14] = 1.44530572F * (z * (xx - yy));
  value[15] = 0.59004359F * (x * (xx - 3 * yy));
}

Light rotated(const Light& light, const float (&rotation)[9]) noexcept {
  Light result;
  for (std::uint32_t k = 0; k < points; ++k) {
    const Point point = rule_point(k);
    const Vec3& d = point.direction;
    const float(&r)[9] = rotation;
    float from[n], to[n];
    light_harmonics(d, from);
    light_harmonics({r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
                     r[6] * d.x + r[7] * d.y + r[8] * d.z},
                    to);
    project(light.red, from, to, point.weight, result.red);
    project(light.green, from, to, point.weight, result.green);
    project(light.blue, from, to, point.weight, result.blue);
  }
  return result;
}

}  // namespace greenloop
