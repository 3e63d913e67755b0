#include "offline/wrap/sharp_surface.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "offline/surface/surface_edges.hpp"
#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

// disturbed vertices go half the way back; later they and those around them are smoothed, too
constexpr int halvings = 4;
constexpr int most_attempts = 10;

struct Plane {
  Vector3d point, normal;
};

using Neighbours = std::vector<std::vector<int>>;

class Original {
 public:
  Original(const TriangleMesh& mesh, const TriangleTree& tree) : mesh_(mesh), tree_(tree) {}

  [[nodiscard]] Plane plane_near(const Vector3d& place) const {
    const SurfacePoint closest = tree_.closest(place);
    const auto& [a, b, c] = mesh_.triangles[static_cast<std::size_t>(closest.triangle)];
    const Vector3d &p = mesh_.vertices[a], &q = mesh_.vertices[b], &r = mesh_.vertices[c];
    return {closest.weights[0] * p + closest.weights[1] * q + closest.weights[2] * r,
            (q - p).cross(r - p).normalized()};
  }

  [[nodiscard]] Vector3d closest(const Vector3d& place) const { return plane_near(place).point; }

 private:
  const TriangleMesh& mesh_;
  const TriangleTree& tree_;
};

/// For each vertex those of its faces that are `steps` further: one, along an edge, or two, across.
Neighbours vertex_neighbours(const QuadSurface& surface, std::size_t steps) {
  Neighbours result(surface.vertices.size());
  for (const auto& quad : surface.quads) {
    for (std::size_t i = 0; i < 4; ++i) {
      result[quad[i]].push_back(quad[(i + steps) % 4]);
      result[quad[(i + steps) % 4]].push_back(quad[i]);
    }
  }
  for (auto& neighbours : result) {
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }
  return result;
}

bool in_cell_of(const Vector3d& vertex, const Vector3d& place, double slack) {
  const Eigen::Array3d low = vertex.array().floor();
  return (place.array() >= low - slack).all() && (place.array() <= low + 1 + slack).all();
}

/// Where the planes meet, if they are those of an edge or a corner.
std::optional<Vector3d> meeting_point(const std::vector<Plane>& planes) {
  Vector3d mean = Vector3d::Zero();
  for (const auto& plane : planes) mean += plane.point / static_cast<double>(planes.size());
  Eigen::Matrix3d quadric = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const auto& [point, normal] : planes) {
    quadric += normal * normal.transpose();
    right += normal * normal.dot(point - mean);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(quadric);
  constexpr double sharp = 0.03;  // of the largest: planes that turn by some 20 degrees
  if (eigen.eigenvalues()[1] < sharp * eigen.eigenvalues()[2]) return std::nullopt;
  Vector3d place = mean;
  for (int i = 0; i < 3; ++i) {
    if (eigen.eigenvalues()[i] < sharp * eigen.eigenvalues()[2]) continue;
    const Vector3d axis = eigen.eigenvectors().col(i);
    place += axis * axis.dot(right) / eigen.eigenvalues()[i];
  }
  return place;
}

/// Where a vertex goes on the original; nothing if that is not in its cell.
std::optional<Vector3d> place_on(const Original& original, const QuadSurface& surface, int vertex,
                                 const std::vector<int>& beside, const std::vector<int>& across) {
  const Vector3d& at = surface.vertices[vertex];
  std::vector<Plane> planes{original.plane_near(at)};
  if ((planes[0].point - at).norm() > 1) return std::nullopt;
  for (const auto* others : {&beside, &across}) {
    for (const int other : *others) planes.push_back(original.plane_near((at + surface.vertices[other]) / 2));
  }
  if (const auto meeting = meeting_point(planes)) {
    const Vector3d place = original.closest(*meeting);
    if (in_cell_of(at, *meeting, 0) && in_cell_of(at, place, 0.1)) return place;
  }
  constexpr double slack = 0.25;
  return in_cell_of(at, planes[0].point, slack) ? std::optional(planes[0].point) : std::nullopt;
}

/// Vertices that follow nothing settle between their neighbours.
void relax(std::vector<Vector3d>& places, const std::vector<bool>& follows, const Neighbours& neighbours) {
  constexpr int sweeps = 50;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (follows[v]) continue;
      Vector3d mean = Vector3d::Zero();
      for (const int other : neighbours[v]) mean += places[other];
      places[v] = mean / static_cast<double>(neighbours[v].size());
    }
  }
}

/// Moves the vertices that are marked, and their neighbours, between their neighbours.
void smooth(std::vector<Vector3d>& places, const std::vector<bool>& marked, const Neighbours& neighbours) {
  const std::vector<Vector3d> before = places;
  for (std::size_t v = 0; v < places.size(); ++v) {
    const auto& around = neighbours[v];
    if (!marked[v] && std::none_of(around.begin(), around.end(), [&](int other) { return marked[other]; })) continue;
    Vector3d mean = Vector3d::Zero();
    for (const int other : around) mean += before[other];
    places[v] = mean / static_cast<double>(around.size());
  }
}

/// Splits a quad from corner 0 to 2, or from 1 to 3.
std::array<std::array<int, 3>, 2> split(const std::array<int, 4>& q, bool from_first) {
  return from_first ? std::array<std::array<int, 3>, 2>{{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}}
                    : std::array<std::array<int, 3>, 2>{{{q[1], q[2], q[3]}, {q[1], q[3], q[0]}}};
}

Vector3d normal_of(const std::vector<Vector3d>& places, const std::array<int, 3>& t) {
  return (places[t[1]] - places[t[0]]).cross(places[t[2]] - places[t[0]]);
}

/// The least of 2 A / lmax^2 of both triangles, negative if they look to different sides.
double worst_quality(const std::vector<Vector3d>& places, const std::array<std::array<int, 3>, 2>& pair) {
  double worst = 1;
  for (const auto& t : pair) {
    const double longest =
        std::max({(places[t[0]] - places[t[1]]).squaredNorm(), (places[t[1]] - places[t[2]]).squaredNorm(),
                  (places[t[2]] - places[t[0]]).squaredNorm()});
    worst = std::min(worst, longest > 0 ? normal_of(places, t).norm() / longest : 0);
  }
  const Vector3d n = normal_of(places, pair[0]), m = normal_of(places, pair[1]);
  return n.dot(m) < -0.5 * n.norm() * m.norm() ? -1 : worst;
}

bool split_from_first(const std::vector<Vector3d>& places, const std::array<int, 4>& q, const Original* original) {
  const Vector3d first = (places[q[0]] + places[q[2]]) / 2, second = (places[q[1]] + places[q[3]]) / 2;
  constexpr double enough = 0.1;
  const double quality_first = worst_quality(places, split(q, true));
  const double quality_second = worst_quality(places, split(q, false));
  if (std::min(quality_first, quality_second) < enough) return quality_first >= quality_second;
  constexpr double flat = 0.02;
  if (original != nullptr && (first - second).norm() > flat) {
    return (original->closest(first) - first).norm() <= (original->closest(second) - second).norm();
  }
  return (places[q[0]] - places[q[2]]).norm() <= (places[q[1]] - places[q[3]]).norm();
}

TriangleMesh triangulated(const std::vector<Vector3d>& places, const QuadSurface& surface, const Original* original) {
  TriangleMesh mesh{places, {}};
  mesh.triangles.reserve(2 * surface.quads.size());
  for (const auto& quad : surface.quads) {
    for (const auto& triangle : split(quad, split_from_first(places, quad, original))) {
      mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

/// Vertices of faces that cross others, of folded pairs and of needles.
std::vector<bool> disturbed_vertices(const TriangleMesh& mesh) {
  std::vector<bool> disturbed(mesh.vertices.size(), false);
  const auto mark = [&](int face) {
    for (const int v : mesh.triangles[static_cast<std::size_t>(face)]) disturbed[v] = true;
  };
  constexpr double needle = 0.05;
  for (std::size_t f = 0; f < mesh.triangles.size(); f += 2) {  // the halves of a quad follow each other
    if (worst_quality(mesh.vertices, {mesh.triangles[f], mesh.triangles[f + 1]}) < needle) {
      mark(static_cast<int>(f));
      mark(static_cast<int>(f) + 1);
    }
  }
  constexpr double folded = -0.95;  // cosine between normals: less than some 20 degrees between faces
  const SurfaceEdges edges(mesh.triangles);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const int f = edges[e][0].face, g = edges[e][1].face;
    const Vector3d n = normal_of(mesh.vertices, mesh.triangles[f]), m = normal_of(mesh.vertices, mesh.triangles[g]);
    if (n.dot(m) < folded * n.norm() * m.norm()) {
      mark(f);
      mark(g);
    }
  }
  for (const auto& [a, b] : self_intersections(mesh, std::vector<bool>(mesh.triangles.size(), false))) {
    mark(a);
    mark(b);
  }
  return disturbed;
}

/// Splits the quads of `surface`, with its vertices at `places`, and moves those of disturbed faces until none is left.
SharpSurface settled(const QuadSurface& surface, std::vector<Vector3d> places, const Neighbours& neighbours,
                     const Original* original) {
  SharpSurface result;
  std::vector<bool> held_back(places.size(), false);
  for (int attempt = 0;; ++attempt) {
    result.mesh = triangulated(places, surface, original);
    if (attempt == most_attempts) break;
    const auto disturbed = disturbed_vertices(result.mesh);
    if (std::none_of(disturbed.begin(), disturbed.end(), [](bool d) { return d; })) break;
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (!disturbed[v]) continue;
      held_back[v] = true;
      places[v] = (places[v] + surface.vertices[v]) / 2;
    }
    if (attempt >= halvings) smooth(places, disturbed, neighbours);
  }
  result.held_back = static_cast<std::size_t>(std::count(held_back.begin(), held_back.end(), true));
  return result;
}

}  // namespace

SharpSurface split_quads(const QuadSurface& surface) {
  auto result = settled(surface, surface.vertices, vertex_neighbours(surface, 1), nullptr);
  result.follows.assign(surface.vertices.size(), true);
  return result;
}

SharpSurface sharpen(const QuadSurface& surface, const TriangleMesh& mesh, const TriangleTree& tree) {
  const Original original(mesh, tree);
  const auto beside = vertex_neighbours(surface, 1), across = vertex_neighbours(surface, 2);
  std::vector<Vector3d> places = surface.vertices;
  std::vector<bool> follows(places.size(), false);
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (const auto place = place_on(original, surface, static_cast<int>(v), beside[v], across[v])) {
      places[v] = *place;
      follows[v] = true;
    }
  }
  relax(places, follows, beside);
  auto result = settled(surface, std::move(places), beside, &original);
  result.follows = std::move(follows);
  return result;
}

}  // namespace greenloop::offline
