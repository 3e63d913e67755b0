#include "offline/report/evening_light.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop::offline {
namespace {

Vec3 towards(const Eigen::Vector3d& direction) {
  const Eigen::Vector3f d = direction.normalized().cast<float>();
  return {d.x(), d.y(), d.z()};
}

float exposure(std::span<const Vec3> radiance) {
  std::vector<float> bright;
  for (const Vec3& c : radiance) bright.push_back(std::max({c.x, c.y, c.z}));
  if (bright.empty()) return 1;
  const auto place = bright.begin() + static_cast<std::ptrdiff_t>(bright.size() - 1 - bright.size() / 100);
  std::nth_element(bright.begin(), place, bright.end());
  return std::max(*place, 1e-6F);
}

float encoded(float linear) {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
}

}  // namespace

Light evening_light(const ViewFrame& frame) {
  float of_sun[Light::coefficients], of_sky[Light::coefficients];
  light_harmonics(towards(0.9 * frame.up - 0.8 * frame.right + 0.5 * frame.towards), of_sun);
  light_harmonics(towards(frame.up), of_sky);
  constexpr float window[] = {1, 0.94F, 0.79F, 0.57F};  // by degree, against ringing
  constexpr float sky_by_degree[] = {4, 0.8F, 0, 0};
  Light light;
  for (std::size_t i = 0; i < Light::coefficients; ++i) {
    const std::size_t degree = i == 0 ? 0 : i < 4 ? 1 : i < 9 ? 2 : 3;
    const float sun = 2.2F * window[degree] * of_sun[i], sky = sky_by_degree[degree] * of_sky[i];
    light.red[i] = sun + 0.28F * sky;
    light.green[i] = 0.88F * sun + 0.31F * sky;
    light.blue[i] = 0.7F * sun + 0.38F * sky;
  }
  return light;
}

std::vector<Eigen::Vector3f> displayed(std::span<const Vec3> radiance) {
  const float brightest = exposure(radiance);
  std::vector<Eigen::Vector3f> colours;
  for (const Vec3& c : radiance)
    colours.emplace_back(encoded(c.x / brightest), encoded(c.y / brightest), encoded(c.z / brightest));
  return colours;
}

}  // namespace greenloop::offline
