#include "rt_tests/bench/contact_sets.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace greenloop::bench {
namespace {

struct Point {
  std::uint32_t node;
  float position[3];
};

std::vector<Point> touchable_points(const ModelView& model) {
  std::vector<Point> points;
  for (std::uint32_t q = 0; q < model.levels; ++q) {
    const LevelView& level = model.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const auto& node = level.nodes[i];
      if ((node.flags & layout::node_touchable) != 0) {
        points.push_back({level.node_begin + i, {node.position[0], node.position[1], node.position[2]}});
      }
    }
  }
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

std::vector<std::uint32_t> touchable_nodes(const ModelView& model) {
  std::vector<std::uint32_t> nodes;
  for (const Point& point : touchable_points(model)) {
    nodes.push_back(point.node);
  }
  return nodes;
}

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
