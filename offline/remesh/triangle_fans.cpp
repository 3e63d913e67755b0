#include "offline/remesh/triangle_fans.hpp"

#include <algorithm>
#include <utility>

namespace greenloop::offline {

TriangleFans::TriangleFans(std::vector<std::array<int, 3>> triangles, std::size_t vertices)
    : corners_(std::move(triangles)), around_(vertices) {
  for (std::size_t t = 0; t < corners_.size(); ++t) {
    for (const int v : corners_[t]) around_[v].push_back(static_cast<int>(t));
  }
}

std::vector<int> TriangleFans::neighbors(int v) const {
  std::vector<int> found;
  for (const int t : around_[v]) {
    for (const int w : corners_[t]) {
      if (w != v) found.push_back(w);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<int> TriangleFans::common_neighbors(int v, int w) const {
  if (valence(w) < valence(v)) return common_neighbors(w, v);
  auto common = neighbors(v);
  std::erase_if(common, [&](int u) { return sides(u, w)[0] < 0; });
  return common;
}

int TriangleFans::following(int t, int v) const {
  const auto& corners = corners_[t];
  return corners[(std::find(corners.begin(), corners.end(), v) - corners.begin() + 1) % 3];
}

std::array<int, 2> TriangleFans::sides(int v, int w) const {
  if (valence(w) < valence(v)) {
    const auto [right, left] = sides(w, v);
    return {left, right};
  }
  std::array<int, 2> found{-1, -1};
  for (const int t : around_[v]) {
    if (following(t, v) == w) found[0] = t;
    if (following(t, following(t, v)) == w) found[1] = t;
  }
  return found;
}

void TriangleFans::collapse(int from, int to) {
  for (const int t : around_[from]) {
    auto& corners = corners_[t];
    if (std::find(corners.begin(), corners.end(), to) != corners.end()) {
      for (const int v : corners) {
        if (v != from) std::erase(around_[v], t);
      }
      corners = {-1, -1, -1};
    } else {
      std::replace(corners.begin(), corners.end(), from, to);
      around_[to].push_back(t);
    }
  }
  around_[from].clear();
}

void TriangleFans::flip(int v, int w) {
  const auto [left, right] = sides(v, w);
  const int above = following(left, w), below = following(right, v);
  corners_[left] = {above, v, below};
  corners_[right] = {below, w, above};
  std::erase(around_[v], right);
  std::erase(around_[w], left);
  around_[above].push_back(right);
  around_[below].push_back(left);
}

int TriangleFans::split(int v, int w) {
  const auto ends = sides(v, w);
  const int middle = static_cast<int>(around_.size());
  around_.emplace_back();
  for (const int t : ends) {
    const int fresh = static_cast<int>(corners_.size());
    auto other = corners_[t];
    std::replace(corners_[t].begin(), corners_[t].end(), w, middle);
    std::replace(other.begin(), other.end(), v, middle);
    corners_.push_back(other);
    std::replace(around_[w].begin(), around_[w].end(), t, fresh);
    around_[middle].insert(around_[middle].end(), {t, fresh});
    for (const int u : other) {
      if (u != middle && u != w) around_[u].push_back(fresh);
    }
  }
  return middle;
}

}  // namespace greenloop::offline
