#include "offline/wrap/rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "offline/wrap/far_distance.hpp"
#include "offline/wrap/level_set.hpp"

namespace greenloop::offline {
namespace {

using Set = std::vector<std::uint8_t>;  // per lattice point, whether it belongs

template <class Test>
Set set_of(const std::vector<float>& values, const Test& test) {
  Set set(values.size());
  std::transform(values.begin(), values.end(), set.begin(), [&](float v) { return test(v) ? 1 : 0; });
  return set;
}

Set complement(Set set) {
  for (auto& s : set) s = 1 - s;
  return set;
}

Set dilated(const Set& set, double radius, const Lattice& lattice) {
  return set_of(distance_to(set, lattice), [&](float d) { return d <= static_cast<float>(radius); });
}

Set eroded(const Set& set, double radius, const Lattice& lattice) {
  return complement(dilated(complement(set), radius, lattice));
}

/// How much a distance grows per spacing, at most, from a point to its neighbours.
float steepest(const std::vector<float>& distance, const Lattice& lattice, std::size_t point) {
  float steepest = 0;
  const auto x = static_cast<std::ptrdiff_t>(lattice.stride(1)), y = static_cast<std::ptrdiff_t>(lattice.stride(2));
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto other = static_cast<std::ptrdiff_t>(point) + dx + x * dy + y * dz;
        const float gain = distance[static_cast<std::size_t>(other)] - distance[point];
        if (gain > 0) steepest = std::max(steepest, gain / std::sqrt(static_cast<float>(dx * dx + dy * dy + dz * dz)));
      }
    }
  }
  return steepest;
}

/// The middle of parts into which a ball of the radius does not fit, but for edges and corners of thick ones.
Set thin_middle(const Set& inside, double radius, const Lattice& lattice) {
  constexpr float ridge = 0.7F;         // elsewhere the depth grows by nearly 1
  constexpr double beyond_corners = 2;  // a right-angled corner is sqrt(3) radii from where the ball fits
  const auto depth = distance_to(complement(inside), lattice);
  const auto thick = set_of(depth, [&](float d) { return d > static_cast<float>(radius); });
  const auto away = distance_to(thick, lattice);
  Set middle(inside.size(), 0);
  for (std::size_t i = 0; i < middle.size(); ++i) {
    if (inside[i] == 0 || !(away[i] > static_cast<float>(beyond_corners * radius))) continue;
    middle[i] = steepest(depth, lattice, i) < ridge ? 1 : 0;
  }
  return middle;
}

/// Means over a cube of 2 reach + 1 points a side.
void blur(std::vector<float>& values, int reach, const Lattice& lattice) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t stride = lattice.stride(axis);
    const int length = lattice.size[axis];
    std::vector<float> line(static_cast<std::size_t>(length));
    for (std::size_t start = 0; start < values.size(); ++start) {
      if (lattice.point(start)[axis] != 0) continue;
      for (int i = 0; i < length; ++i) line[i] = values[start + static_cast<std::size_t>(i) * stride];
      const auto at = [&](int i) { return line[std::clamp(i, 0, length - 1)]; };
      double sum = 0;
      for (int i = -reach; i <= reach; ++i) sum += at(i);
      for (int i = 0; i < length; ++i) {
        values[start + static_cast<std::size_t>(i) * stride] = static_cast<float>(sum / (2 * reach + 1));
        sum += at(i + reach + 1) - at(i - reach);
      }
    }
  }
}

}  // namespace

void round_solid(std::vector<float>& field, const Lattice& lattice, double radius) {
  Set inside = set_of(field, [](float v) { return v < 0; });
  const auto thickened = dilated(thin_middle(inside, radius, lattice), radius, lattice);
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] |= thickened[i];
  inside = eroded(dilated(inside, radius, lattice), radius, lattice);
  const double opening = 0.8 * radius;  // less than what was thickened
  inside = dilated(eroded(inside, opening, lattice), opening, lattice);
  const auto in = distance_to(complement(inside), lattice), out = distance_to(inside, lattice);
  const auto reach = static_cast<float>(radius) + band;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const float rounded = std::clamp(inside[i] != 0 ? 0.5F - in[i] : out[i] - 0.5F, -reach, reach);
    const bool moved = std::abs(rounded - field[i]) > 1;  // elsewhere the field is more exact than its points
    if (moved) field[i] = rounded;
  }
  for (int pass = 0; pass < 2; ++pass) blur(field, std::max(1, static_cast<int>(radius / 3)), lattice);
  for (float& value : field) value = std::clamp(value, -band, band);
}

}  // namespace greenloop::offline
