#include "offline/surface/box_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace greenloop::offline {
namespace {

constexpr int leaf_size = 8;

struct Node {
  Eigen::AlignedBox3d box;
  int begin = 0;  ///< range of items
  int end = 0;
  int left = -1;  ///< children, -1 in a leaf
  int right = -1;
};

class BoxTree {
 public:
  BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes, const std::function<bool(int, int)>& visit)
      : boxes_(boxes), visit_(visit), items_(boxes.size()) {
    std::iota(items_.begin(), items_.end(), 0);
    if (!items_.empty()) {
      build(0, static_cast<int>(items_.size()));
    }
  }

  void visit_pairs() const {
    if (!nodes_.empty()) {
      static_cast<void>(within(0));
    }
  }

 private:
  int build(int begin, int end) {
    const int index = static_cast<int>(nodes_.size());
    nodes_.emplace_back();
    Eigen::AlignedBox3d box;
    Eigen::AlignedBox3d centres;
    for (int i = begin; i < end; ++i) {
      box.extend(boxes_[items_[i]]);
      centres.extend(boxes_[items_[i]].center());
    }
    Node node{box, begin, end, -1, -1};
    if (end - begin > leaf_size) {
      Eigen::Index axis = 0;
      centres.sizes().maxCoeff(&axis);
      const int middle = begin + (end - begin) / 2;
      std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end, [&](int i, int j) {
        return std::pair(boxes_[i].center()[axis], i) < std::pair(boxes_[j].center()[axis], j);
      });
      node.left = build(begin, middle);
      node.right = build(middle, end);
    }
    nodes_[index] = node;
    return index;
  }

  // each of these returns false once the visitor did

  [[nodiscard]] bool within(int index) const {
    const auto& node = nodes_[index];
    if (node.left >= 0) {
      return within(node.left) && within(node.right) && between(node.left, node.right);
    }
    for (int i = node.begin; i < node.end; ++i) {
      for (int j = i + 1; j < node.end; ++j) {
        if (!visit_if_overlapping(items_[i], items_[j])) {
          return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool between(int a, int b) const {
    const auto& s = nodes_[a];
    const auto& t = nodes_[b];
    if (!s.box.intersects(t.box)) {
      return true;
    }
    if (s.left >= 0 && (t.left < 0 || s.end - s.begin >= t.end - t.begin)) {
      return between(s.left, b) && between(s.right, b);
    }
    if (t.left >= 0) {
      return between(a, t.left) && between(a, t.right);
    }
    for (int i = s.begin; i < s.end; ++i) {
      for (int j = t.begin; j < t.end; ++j) {
        if (!visit_if_overlapping(items_[i], items_[j])) {
          return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool visit_if_overlapping(int i, int j) const {
    return !boxes_[i].intersects(boxes_[j]) || visit_(i, j);
  }

  const std::vector<Eigen::AlignedBox3d>& boxes_;
  const std::function<bool(int, int)>& visit_;
  std::vector<int> items_;
  std::vector<Node> nodes_;
};

}  // namespace

void for_each_overlap(const std::vector<Eigen::AlignedBox3d>& boxes, const std::function<bool(int, int)>& visit) {
  BoxTree(boxes, visit).visit_pairs();
}

}  // namespace greenloop::offline
