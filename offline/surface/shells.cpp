#include "offline/surface/shells.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/surface_edges.hpp"

namespace greenloop::offline {
namespace {

/// The piece of every vertex, named by the first of its vertices.
std::vector<int> pieces_of_vertices(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.unite(a, b);
    sets.unite(b, c);
  }
  std::vector<int> piece;
  for (std::size_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    piece.push_back(sets.find(static_cast<int>(vertex)));
  }
  return piece;
}

std::vector<TriangleMesh> pieces(const TriangleMesh& mesh) {
  const auto piece_of = pieces_of_vertices(mesh);
  std::vector<TriangleMesh> found;
  std::vector<int> number(mesh.vertices.size(), -1), renumbered(mesh.vertices.size(), -1);
  for (auto triangle : mesh.triangles) {
    int& piece = number[piece_of[triangle[0]]];
    if (piece < 0) {
      piece = static_cast<int>(found.size());
      found.emplace_back();
    }
    TriangleMesh& to = found[piece];
    for (int& vertex : triangle) {
      int& mine = renumbered[vertex];
      if (mine < 0) {
        mine = static_cast<int>(to.vertices.size());
        to.vertices.push_back(mesh.vertices[vertex]);
      }
      vertex = mine;
    }
    to.triangles.push_back(triangle);
  }
  return found;
}

void turn(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

/// Whether a closed surface encloses a point that is not on it: the solid angles of its faces (Van Oosterom, Strackee
/// 1983) add up to 4 pi.
bool encloses(const TriangleMesh& surface, const Eigen::Vector3d& point) {
  double half = 0;
  for (const auto& [i, j, k] : surface.triangles) {
    const Eigen::Vector3d a = surface.vertices[i] - point, b = surface.vertices[j] - point,
                          c = surface.vertices[k] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    half += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(half) > EIGEN_PI;
}

std::string piece_text(const TriangleMesh& piece) {
  const Eigen::Vector3d& at = piece.vertices.front();
  return fmt::format("a piece of {} faces at ({:.6g}, {:.6g}, {:.6g})", piece.triangles.size(), at.x(), at.y(), at.z());
}

void require_cavities(const Shells& shells) {
  for (const auto& cavity : shells.cavities) {
    const Eigen::Vector3d& at = cavity.vertices.front();
    if (!encloses(shells.skin, at)) {
      throw std::runtime_error("several pieces: " + piece_text(cavity) +
                               " is no cavity, it lies outside of the largest; remove it, or join them");
    }
    const auto around = [&](const TriangleMesh& other) { return &other != &cavity && encloses(other, at); };
    if (std::any_of(shells.cavities.begin(), shells.cavities.end(), around)) {
      throw std::runtime_error("several pieces: " + piece_text(cavity) +
                               " lies in a cavity, where it is a body of its own; remove it");
    }
  }
}

}  // namespace

Shells split_shells(const TriangleMesh& mesh) {
  auto found = pieces(mesh);
  if (found.empty()) throw std::runtime_error("no faces at all");
  if (found.size() > most_cavities + 1) {
    throw std::runtime_error(
        fmt::format("several pieces: {}; a body may have {} cavities", found.size(), most_cavities));
  }
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t p = 0; p < found.size(); ++p) {
    const double volume = enclosed_volume(found[p]);
    if (volume < 0) turn(found[p]);
    order.emplace_back(-std::abs(volume), p);
  }
  std::sort(order.begin(), order.end());
  Shells shells{std::move(found[order.front().second]), {}};
  for (std::size_t k = 1; k < order.size(); ++k) shells.cavities.push_back(std::move(found[order[k].second]));
  require_cavities(shells);
  return shells;
}

TriangleMesh walls_of(const std::vector<TriangleMesh>& cavities) {
  TriangleMesh walls;
  for (const auto& cavity : cavities) walls = joined(std::move(walls), cavity);
  turn(walls);
  return walls;
}

TriangleMesh inward_pieces(const TriangleMesh& mesh) {
  const auto piece_of = pieces_of_vertices(mesh);
  std::vector<double> sixfold_volume(mesh.vertices.size(), 0);
  const auto& v = mesh.vertices;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d& origin = v[piece_of[a]];
    sixfold_volume[piece_of[a]] += (v[a] - origin).dot((v[b] - origin).cross(v[c] - origin));
  }
  TriangleMesh inward{mesh.vertices, {}};
  std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(inward.triangles),
               [&](const auto& triangle) { return sixfold_volume[piece_of[triangle[0]]] < 0; });
  return inward;
}

double volume_of_all(const std::vector<TriangleMesh>& cavities) {
  return std::accumulate(cavities.begin(), cavities.end(), 0.0,
                         [](double sum, const TriangleMesh& cavity) { return sum + enclosed_volume(cavity); });
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + first, j + first, k + first});
  return a;
}

}  // namespace greenloop::offline
