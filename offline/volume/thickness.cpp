#include "offline/volume/thickness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double most_tests = 3e8;

// the level whose nodes are the first `nodes`
int level_of(const SemiRegularMesh& surface, std::size_t nodes) {
  const auto end = std::find(surface.vertex_end.begin(), surface.vertex_end.end(), nodes);
  return static_cast<int>(std::distance(surface.vertex_end.begin(), end));
}

std::size_t nodes_to_look_from(const SemiRegularMesh& surface, std::size_t triangles) {
  const auto& ends = surface.vertex_end;
  const auto few = [&](std::size_t nodes) {
    return static_cast<double>(nodes) * static_cast<double>(triangles) <= most_tests;
  };
  const auto found = std::find_if(ends.rbegin(), ends.rend(), few);
  return found == ends.rend() ? ends.front() : *found;
}

// towards the inside, not of unit length
std::vector<Vector3d> inward_normals(const TriangleMesh& surface) {
  std::vector<Vector3d> normals(surface.vertices.size(), Vector3d::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const auto& v = surface.vertices;
    const Vector3d normal = (v[c] - v[a]).cross(v[b] - v[a]);
    for (const int corner : {a, b, c}) normals[corner] += normal;
  }
  return normals;
}

std::vector<double> mean_edges(const TriangleMesh& surface) {
  std::vector<double> sum(surface.vertices.size(), 0), count(surface.vertices.size(), 0);
  for (const auto& triangle : surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      const double length = (surface.vertices[a] - surface.vertices[b]).norm();
      for (const int end : {a, b}) sum[end] += length, count[end] += 1;
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(count[i], 1.0);
  return sum;
}

// corners and two sides of a triangle, made once for all rays
struct Target {
  Vector3d corner, first, second;
};

void add_targets(const TriangleMesh& mesh, std::vector<Target>& targets) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& v = mesh.vertices;
    targets.push_back({v[a], v[b] - v[a], v[c] - v[a]});
  }
}

// how far a ray has to go until it leaves the body through a triangle (Moeller & Trumbore 1997); infinite: it does not
double way_out(const Vector3d& origin, const Vector3d& direction, const Target& target) {
  constexpr double never = std::numeric_limits<double>::infinity();
  constexpr double round_off = 1e-9;  // a ray through a common edge meets one of the two
  const Vector3d across = direction.cross(target.second);
  const double determinant = target.first.dot(across);
  if (!(determinant < 0)) return never;  // outward normals: it enters, or passes by
  const Vector3d from = origin - target.corner;
  const double u = from.dot(across) / determinant;
  if (u < -round_off || u > 1 + round_off) return never;
  const Vector3d along = from.cross(target.first);
  const double v = direction.dot(along) / determinant;
  if (v < -round_off || u + v > 1 + round_off) return never;
  const double way = target.second.dot(along) / determinant;
  return way > 0 ? way : never;
}

bool has_corner(const std::array<int, 3>& triangle, int node) {
  return std::find(triangle.begin(), triangle.end(), node) != triangle.end();
}

Chord chord_from(int node, const Vector3d& direction, const TriangleMesh& surface, const std::vector<Target>& targets) {
  Chord chord{.length = std::numeric_limits<double>::infinity()};
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const double way = way_out(surface.vertices[node], direction, targets[t]);
    if (!(way < chord.length)) continue;
    if (t < surface.triangles.size() && has_corner(surface.triangles[t], node)) continue;
    chord.length = way;
    chord.triangle = static_cast<int>(t);
  }
  return chord;
}

std::vector<std::vector<int>> neighbours_in(const TetrahedralMesh& volume) {
  std::vector<std::vector<int>> neighbours(volume.vertices.size());
  for (const auto& corners : volume.tetrahedra) {
    for (const int a : corners) {
      for (const int b : corners) {
        if (a != b) neighbours[a].push_back(b);
      }
    }
  }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

void add_vertices_of(int node, const Interpolation& interpolation, std::vector<int>& vertices) {
  for (Interpolation::InnerIterator it(interpolation, node); it; ++it) {
    if (it.value() > 0) vertices.push_back(static_cast<int>(it.col()));
  }
}

// breadth-first search, ring by ring
class Layers {
 public:
  explicit Layers(const TetrahedralMesh& volume)
      : neighbours_(neighbours_in(volume)), reached_(volume.vertices.size(), -1) {}

  double between(std::vector<int> ring, const std::vector<int>& goal) {
    ++search_;
    for (const int vertex : ring) reached_[vertex] = search_;
    int layers = 0;
    while (layers < most_layers && !meets(goal)) {
      ring = next_ring(ring);
      ++layers;
    }
    return layers;
  }

 private:
  [[nodiscard]] bool meets(const std::vector<int>& goal) const {
    return std::any_of(goal.begin(), goal.end(), [&](int vertex) { return reached_[vertex] == search_; });
  }

  std::vector<int> next_ring(const std::vector<int>& ring) {
    std::vector<int> next;
    for (const int vertex : ring) {
      for (const int neighbour : neighbours_[vertex]) {
        if (std::exchange(reached_[neighbour], search_) != search_) next.push_back(neighbour);
      }
    }
    return next;
  }

  std::vector<std::vector<int>> neighbours_;
  std::vector<int> reached_;  // by which search last
  int search_ = -1;
};

}  // namespace

double Chord::elements() const { return triangle < 0 ? std::numeric_limits<double>::infinity() : length / spacing; }

std::vector<Chord> inward_chords(const SemiRegularMesh& mesh, const TriangleMesh& walls) {
  const TriangleMesh surface = finest_surface(mesh);
  const auto inward = inward_normals(surface);
  const auto spacing = mean_edges(surface);
  std::vector<Target> targets;
  add_targets(surface, targets);
  add_targets(walls, targets);
  std::vector<Chord> chords(nodes_to_look_from(mesh, targets.size()));
  for (std::size_t node = 0; node < chords.size(); ++node) {
    chords[node] = chord_from(static_cast<int>(node), inward[node].normalized(), surface, targets);
    chords[node].spacing = spacing[node];
  }
  return chords;
}

std::vector<double> layers_along(const std::vector<Chord>& chords, const SemiRegularMesh& mesh,
                                 const TriangleMesh& walls, const TetrahedralMesh& volume,
                                 const Interpolation& interpolation) {
  const TriangleMesh surface = finest_surface(mesh);
  const int outside = static_cast<int>(surface.triangles.size());
  Layers layers(volume);
  std::vector<double> along(chords.size(), most_layers);
  for (std::size_t node = 0; node < chords.size(); ++node) {
    if (chords[node].triangle < 0) continue;
    std::vector<int> here, there;
    add_vertices_of(static_cast<int>(node), interpolation, here);
    if (const int met = chords[node].triangle; met < outside) {
      for (const int corner : surface.triangles[met]) add_vertices_of(corner, interpolation, there);
    } else {
      there.assign(walls.triangles[met - outside].begin(), walls.triangles[met - outside].end());
    }
    along[node] = layers.between(std::move(here), there);
  }
  return along;
}

ThinnestPart thinnest_part(const SemiRegularMesh& surface, const std::vector<double>& elements) {
  std::vector<double> around = elements;
  for (const auto& triangle : triangles_of_level(surface, level_of(surface, elements.size()))) {
    for (const int a : triangle) {
      for (const int b : triangle) around[a] = std::max(around[a], elements[b]);
    }
  }
  const auto least = std::min_element(around.begin(), around.end());
  return {static_cast<std::size_t>(std::distance(around.begin(), least)), *least};
}

}  // namespace greenloop::offline
