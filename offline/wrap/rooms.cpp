#include "offline/wrap/rooms.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "offline/wrap/far_distance.hpp"

namespace greenloop::offline {
namespace {

/// Points from the greatest distance to the least, equal ones in their order, in steps of 1/16.
std::vector<int> far_to_near(const std::vector<float>& distance) {
  const auto step = [&](std::size_t i) { return static_cast<std::size_t>(distance[i] * 16); };
  std::size_t steps = 0;
  for (std::size_t i = 0; i < distance.size(); ++i) steps = std::max(steps, step(i) + 1);
  std::vector<std::size_t> begin(steps + 1, 0);
  for (std::size_t i = 0; i < distance.size(); ++i) ++begin[steps - step(i)];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<int> order(distance.size());
  for (std::size_t i = 0; i < distance.size(); ++i) order[begin[steps - step(i) - 1]++] = static_cast<int>(i);
  return order;
}

/// Rooms that grow from their widest places until they meet. A room goes by that place.
class Watershed {
 public:
  Watershed(const std::vector<float>& distance, const std::vector<std::uint8_t>& crossed, const Lattice& lattice)
      : distance_(distance),
        crossed_(crossed),
        lattice_(lattice),
        parent_(distance.size() + 1, none),
        outside_(static_cast<int>(distance.size())) {
    parent_[outside_] = outside_;
  }

  void run() {
    for (const int point : far_to_near(distance_)) enter(point);
  }

  [[nodiscard]] Rooms result() {
    Rooms result;
    result.rooms.push_back({std::numeric_limits<double>::infinity(), 0, false});
    std::vector<int> number(parent_.size(), none);
    number[outside_] = 0;
    result.room_of.resize(distance_.size());
    for (int point = 0; point < outside_; ++point) {
      const int root = find(point);
      if (number[root] == none) {
        number[root] = static_cast<int>(result.rooms.size());
        const auto hole = holes_.find(root);
        result.rooms.push_back({distance_[root], hole == holes_.end() ? 0 : hole->second, false});
      }
      result.room_of[point] = number[root];
    }
    return result;
  }

 private:
  static constexpr int none = -1;

  int find(int point) {
    while (parent_[point] != point) point = parent_[point] = parent_[parent_[point]];
    return point;
  }

  /// The neighbours that have entered and that no face keeps apart; the outside is one of those on the boundary.
  template <class Visit>
  void for_each_neighbour(int point, const Visit& visit) {
    const auto at = lattice_.point(static_cast<std::size_t>(point));
    if (!lattice_.inner(at)) visit(outside_);
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = static_cast<int>(lattice_.stride(axis));
      const unsigned bit = 1U << static_cast<unsigned>(axis);
      if (at[axis] > 0 && (crossed_[point - stride] & bit) == 0) visit(point - stride);
      if (at[axis] + 1 < lattice_.size[axis] && (crossed_[point] & bit) == 0) visit(point + stride);
    }
  }

  [[nodiscard]] float height(int point) const {
    return point == outside_ ? std::numeric_limits<float>::infinity() : distance_[point];
  }

  void enter(int point) {
    int highest = none;
    for_each_neighbour(point, [&](int other) {
      if (parent_[other] != none && (highest == none || height(other) > height(highest))) highest = other;
    });
    if (highest == none) {
      parent_[point] = point;
      return;
    }
    parent_[point] = find(highest);
    for_each_neighbour(point, [&](int other) {
      if (parent_[other] != none) meet(find(point), find(other), distance_[point]);
    });
  }

  void meet(int a, int b, double opening) {
    if (a == b) return;
    if (height(a) < height(b)) std::swap(a, b);
    if (a == outside_) {
      const bool shut = holes_.contains(b) || distance_[b] >= 2 * opening;
      if (shut) {
        holes_.try_emplace(b, opening);
        return;
      }
    } else if (const auto hole = holes_.find(b); hole != holes_.end()) {
      auto& greater = holes_[a];
      greater = std::max(greater, hole->second);
    }
    parent_[b] = a;
  }

  const std::vector<float>& distance_;
  const std::vector<std::uint8_t>& crossed_;
  const Lattice& lattice_;
  std::vector<int> parent_;
  int outside_;
  std::map<int, double> holes_;  ///< of rooms that are not shut, by room
};

template <class Visit>
void for_each_wall(const Rooms& rooms, const TriangleMesh& mesh, const std::vector<Crossing>& crossings,
                   const Lattice& lattice, const Visit& visit) {
  const auto area = area_of_crossing(mesh);
  for (const auto& crossing : crossings) {
    visit(rooms.room_of[crossing.point], rooms.room_of[crossing.next_point(lattice)],
          area[static_cast<std::size_t>(crossing.face)]);
  }
}

}  // namespace

Rooms find_rooms(const std::vector<float>& distance, const TriangleMesh& mesh, const std::vector<Crossing>& crossings,
                 const Lattice& lattice) {
  const auto far = far_distance(distance, lattice);
  const auto crossed = crossed_axes(crossings, lattice);
  Watershed watershed(far, crossed, lattice);
  watershed.run();
  Rooms result = watershed.result();
  auto& rooms = result.rooms;
  const auto shut = [&](int room) { return room != 0 && rooms[room].hole == 0; };
  std::vector<double> bare(rooms.size(), 0);  // area of walls with nothing solid behind them, less that of the others
  for_each_wall(result, mesh, crossings, lattice, [&](int a, int b, double area) {
    bare[a] += shut(b) ? -area : area;
    bare[b] += shut(a) ? -area : area;
  });
  for (std::size_t r = 1; r < rooms.size(); ++r) rooms[r].inside = rooms[r].hole == 0 || bare[r] > 0;
  return result;
}

}  // namespace greenloop::offline
