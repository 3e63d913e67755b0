#include "offline/report/colour_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr std::array<unsigned, 7> stops{0xe4e6e6, 0xf7dc97, 0xf5ac5c, 0xe2724c, 0xb83a5b, 0x7a1f6c, 0x38124f};

Colour unpack(unsigned rgb) {
  return Colour(static_cast<float>(rgb >> 16 & 255), static_cast<float>(rgb >> 8 & 255),
                static_cast<float>(rgb & 255)) /
         255.0F;
}

float linear_component(float component) {
  return component <= 0.04045F ? component / 12.92F : std::pow((component + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

Colour displacement_colour(float value) {
  constexpr int last = static_cast<int>(stops.size()) - 1;
  const float place = std::clamp(value, 0.0F, 1.0F) * last;
  const int below = std::min(static_cast<int>(place), last - 1);
  const float weight = place - static_cast<float>(below);
  return (1 - weight) * unpack(stops[below]) + weight * unpack(stops[below + 1]);
}

std::vector<std::string> displacement_gradient(int count) {
  std::vector<std::string> colours;
  for (int i = 0; i < count; ++i) {
    const Colour colour = displacement_colour(static_cast<float>(i) / static_cast<float>(count - 1)) * 255;
    colours.push_back(
        fmt::format("#{:02x}{:02x}{:02x}", std::lround(colour.x()), std::lround(colour.y()), std::lround(colour.z())));
  }
  return colours;
}

float luminance(const Colour& colour) {
  return 0.2126F * linear_component(colour.x()) + 0.7152F * linear_component(colour.y()) +
         0.0722F * linear_component(colour.z());
}

}  // namespace greenloop::offline
