#include "offline/multigrid/vertex_stiffness.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

namespace greenloop::offline {
namespace {

/// Sets that are joined two by two.
class Sets {
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t first_of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t first = first_of(a), second = first_of(b);
    parent_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

bool alike(double a, double b) { return a < b * VertexStiffness::contrast && b < a * VertexStiffness::contrast; }

struct Face {
  std::array<int, 3> vertex;
  std::uint32_t tetrahedron;

  bool operator<(const Face& other) const {
    return std::tie(vertex, tetrahedron) < std::tie(other.vertex, other.tetrahedron);
  }
};

std::vector<Face> sorted_faces(const TetrahedralMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto& corner = mesh.tetrahedra[t];
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<int, 3> face{corner[(left_out + 1) % 4], corner[(left_out + 2) % 4], corner[(left_out + 3) % 4]};
      std::sort(face.begin(), face.end());
      faces.push_back({face, static_cast<std::uint32_t>(t)});
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

/// Of tetrahedra that are joined by faces, from one to the next about as stiff.
std::vector<std::uint32_t> pieces(const TetrahedralMesh& mesh, std::span<const double> young) {
  std::vector<std::uint32_t> piece(young.size(), 0);
  const auto [least, most] = std::minmax_element(young.begin(), young.end());
  if (alike(*least, *most)) return piece;
  Sets sets(young.size());
  const std::vector<Face> faces = sorted_faces(mesh);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const Face &a = faces[i - 1], &b = faces[i];
    if (a.vertex == b.vertex && alike(young[a.tetrahedron], young[b.tetrahedron]))
      sets.join(a.tetrahedron, b.tetrahedron);
  }
  for (std::uint32_t t = 0; t < piece.size(); ++t) piece[t] = sets.first_of(t);
  return piece;
}

}  // namespace

bool VertexStiffness::follows(std::uint32_t vertex, const VertexStiffness& other, std::uint32_t other_vertex) const {
  const double ratio = other.young[other_vertex] / young[vertex];
  return ratio >= contrast || (ratio * contrast > 1.0 && other.piece[other_vertex] == piece[vertex]);
}

VertexStiffness vertex_stiffness(const TetrahedralMesh& mesh, std::span<const double> young) {
  if (young.size() != mesh.tetrahedra.size() || young.empty()) {
    throw std::invalid_argument("multigrid: " + std::to_string(young.size()) + " moduli for " +
                                std::to_string(mesh.tetrahedra.size()) + " tetrahedra");
  }
  const std::vector<std::uint32_t> piece = pieces(mesh, young);
  VertexStiffness result{std::vector<double>(mesh.vertices.size(), 0.0),
                         std::vector<std::uint32_t>(mesh.vertices.size(), 0)};
  for (std::size_t t = 0; t < young.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      if (young[t] <= result.young[v]) continue;
      result.young[v] = young[t];
      result.piece[v] = piece[t];
    }
  }
  return result;
}

}  // namespace greenloop::offline
