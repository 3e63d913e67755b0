#include "offline/wrap/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "offline/wrap/level_set.hpp"

namespace greenloop::offline {
namespace {

// how far inside a point is put that is added
constexpr float just_inside = -0.05F;

/// Sets of points that hang together along edges of the lattice.
class Flood {
 public:
  explicit Flood(const Lattice& lattice) : lattice_(lattice), number_(lattice.count(), 0) {}

  /// Numbers the points that hang together with `seed` among those that pass the test; returns how many they are.
  template <class Test>
  std::size_t fill(std::size_t seed, int number, const Test& test) {
    std::size_t count = 0;
    std::vector<std::size_t> stack{seed};
    number_[seed] = number;
    while (!stack.empty()) {
      const std::size_t point = stack.back();
      stack.pop_back();
      ++count;
      const auto at = lattice_.point(point);
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t stride = lattice_.stride(axis);
        const auto enter = [&](std::size_t other) {
          if (number_[other] != 0 || !test(other)) return;
          number_[other] = number;
          stack.push_back(other);
        };
        if (at[axis] > 0) enter(point - stride);
        if (at[axis] + 1 < lattice_.size[axis]) enter(point + stride);
      }
    }
    return count;
  }

  [[nodiscard]] int number(std::size_t point) const { return number_[point]; }

 private:
  const Lattice& lattice_;
  std::vector<int> number_;
};

void fill_hollows(std::vector<float>& field, const Lattice& lattice) {
  Flood outside(lattice);
  outside.fill(0, 1, [&](std::size_t i) { return field[i] >= 0; });
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (outside.number(i) == 0 && field[i] >= 0) field[i] = std::min(-field[i], just_inside);
  }
}

/// Points as offsets of a unit cube's corners, bit a for axis a.
std::size_t corner(const Lattice& lattice, std::size_t point, unsigned bits) {
  for (int axis = 0; axis < 3; ++axis) {
    if ((bits >> static_cast<unsigned>(axis) & 1U) != 0) point += lattice.stride(axis);
  }
  return point;
}

/// The outside point nearest to the surface among some.
template <std::size_t count>
std::size_t nearest_outside(const std::vector<float>& field, const std::array<std::size_t, count>& points) {
  return *std::min_element(points.begin(), points.end(), [&](std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t i) { return field[i] < 0 ? 2 * band : field[i]; };
    return key(a) < key(b);
  });
}

/// Adds a point where the cell at `point` is not well-composed; returns whether it did.
bool compose_cell(std::vector<float>& field, const Lattice& lattice, std::size_t point) {
  std::array<std::size_t, 8> corners{};
  unsigned inside = 0;
  for (unsigned bits = 0; bits < 8; ++bits) {
    corners[bits] = corner(lattice, point, bits);
    if (field[corners[bits]] < 0) inside |= 1U << bits;
  }
  if (inside == 0 || inside == 0xff) return false;
  const auto add = [&](const auto& points) {
    field[nearest_outside(field, points)] = just_inside;
    return true;
  };
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned u = 1U << (axis + 1) % 3, v = 1U << (axis + 2) % 3;
    for (const unsigned base : {0U, 1U << axis}) {
      const auto in = [&](unsigned bits) { return (inside >> bits & 1U) != 0; };
      if (in(base) == in(base | u | v) && in(base | u) == in(base | v) && in(base) != in(base | u)) {
        return add(std::array{corners[base], corners[base | u], corners[base | v], corners[base | u | v]});
      }
    }
  }
  for (unsigned bits = 0; bits < 4; ++bits) {
    const unsigned pair = 1U << bits | 1U << (7 - bits);
    if (inside == pair || inside == (0xffU & ~pair)) return add(corners);
  }
  return false;
}

}  // namespace

Pieces keep_largest_piece(std::vector<float>& field, const Lattice& lattice) {
  Flood flood(lattice);
  std::vector<std::size_t> sizes{0};  // by number
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i] < 0 && flood.number(i) == 0) {
      sizes.push_back(flood.fill(i, static_cast<int>(sizes.size()), [&](std::size_t j) { return field[j] < 0; }));
    }
  }
  const auto largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field[i] < 0 && flood.number(i) != largest) field[i] = -field[i];
  }
  fill_hollows(field, lattice);
  Pieces pieces(sizes.begin() + 1, sizes.end());
  std::sort(pieces.begin(), pieces.end(), std::greater<>());
  return pieces;
}

void make_well_composed(std::vector<float>& field, const Lattice& lattice) {
  std::vector<std::size_t> cells(field.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = i;
  while (!cells.empty()) {
    std::vector<std::size_t> again;
    for (const std::size_t cell : cells) {
      const auto at = lattice.point(cell);
      const bool whole = at[0] + 1 < lattice.size[0] && at[1] + 1 < lattice.size[1] && at[2] + 1 < lattice.size[2];
      if (!whole || !compose_cell(field, lattice, cell)) continue;
      for (int dz = -1; dz <= 1; ++dz) {
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const std::array<int, 3> near{at[0] + dx, at[1] + dy, at[2] + dz};
            if (std::all_of(near.begin(), near.end(), [](int x) { return x >= 0; }) && near[0] < lattice.size[0] &&
                near[1] < lattice.size[1] && near[2] < lattice.size[2]) {
              again.push_back(lattice.index(near));
            }
          }
        }
      }
    }
    std::sort(again.begin(), again.end());
    again.erase(std::unique(again.begin(), again.end()), again.end());
    cells = std::move(again);
  }
}

}  // namespace greenloop::offline
