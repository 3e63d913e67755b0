#include "rt_tests/bench/contact_sets.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop::bench {
namespace {

struct Point {
  std::uint32_t node;
  float position[3];
};

std::vector<Point> touchable_points(const ModelView& model) {
  std::vector<Point> points;
  visit_touchable(model, [&points](std::uint32_t node, const layout::NodeRecord& record) {
    points.push_back({node, {record.position[0], record.position[1], record.position[2]}});
  });
  return points;
}

float squared_distance(const Point& a, const Point& b) {
  float sum = 0;
  for (int i = 0; i < 3; ++i) {
    sum += (a.position[i] - b.position[i]) * (a.position[i] - b.position[i]);
  }
  return sum;
}

float diagonal(const layout::Info& info) {
  float sum = 0;
  for (int i = 0; i < 3; ++i) {
    sum += (info.box_max[i] - info.box_min[i]) * (info.box_max[i] - info.box_min[i]);
  }
  return std::sqrt(sum);
}

/// One of the three axes, forwards or backwards.
Constraint pressed(std::uint32_t node, std::uint64_t direction, float depth) {
  Constraint contact{node, {}};
  contact.value[direction % 3] = direction % 2 == 0 ? depth : -depth;
  return contact;
}

}  // namespace

std::vector<std::vector<Constraint>> patch_contacts(const ModelView& model, std::size_t sets, std::size_t contacts,
                                                    std::uint64_t seed) {
  auto points = touchable_points(model);
  contacts = std::min(contacts, points.size());
  const float depth = diagonal(*model.info) / 1000;
  std::mt19937_64 random(seed);
  std::vector<std::vector<Constraint>> result(sets);
  for (auto& set : result) {
    const Point centre = points[random() % points.size()];
    const std::uint64_t direction = random() % 6;
    std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
      const float to_a = squared_distance(a, centre), to_b = squared_distance(b, centre);
      return to_a != to_b ? to_a < to_b : a.node < b.node;
    });
    for (std::size_t i = 0; i < contacts; ++i) {
      set.push_back(pressed(points[i].node, direction, depth));
    }
  }
  return result;
}

}  // namespace greenloop::bench
