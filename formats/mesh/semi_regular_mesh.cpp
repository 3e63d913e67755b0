#include "formats/mesh/semi_regular_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace greenloop {
namespace {

std::uint64_t edge_key(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(low)) << 32) | static_cast<std::uint32_t>(high);
}

}  // namespace

std::vector<std::array<int, 3>> triangles_of_level(const SemiRegularMesh& mesh, int level) {
  auto triangles = mesh.base_triangles;
  for (int l = 1; l <= level; ++l) {
    std::unordered_map<std::uint64_t, int> midpoint;
    for (std::size_t v = mesh.vertex_end[l - 1]; v < mesh.vertex_end[l]; ++v) {
      midpoint.emplace(edge_key(mesh.parents[v][0], mesh.parents[v][1]), static_cast<int>(v));
    }
    const auto find = [&](int a, int b) {
      const auto it = midpoint.find(edge_key(a, b));
      if (it == midpoint.end()) {
        throw std::invalid_argument("semi-regular mesh: edge (" + std::to_string(a) + ", " + std::to_string(b) +
                                    ") has no midpoint on level " + std::to_string(l));
      }
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    finer.reserve(4 * triangles.size());
    for (const auto& [a, b, c] : triangles) {
      const int ab = find(a, b), bc = find(b, c), ca = find(c, a);
      finer.push_back({a, ab, ca});
      finer.push_back({ab, b, bc});
      finer.push_back({ca, bc, c});
      finer.push_back({ab, bc, ca});
    }
    triangles = std::move(finer);
  }
  return triangles;
}

}  // namespace greenloop
