// Stereolithography: a soup of facets. Binary: 80 bytes, uint32 count, then 50 bytes each; ascii: "solid".
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

constexpr std::size_t binary_header = 84;
constexpr std::size_t binary_facet = 50;

/// Collects facets, giving equal positions one vertex; vertices are numbered by first appearance.
class Soup {
 public:
  int vertex(const Eigen::Vector3d& position) {
    const Eigen::Vector3d p = position.array() + 0.0;  // -0 becomes 0
    const auto [it, fresh] = index_.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(mesh.vertices.size()));
    if (fresh) {
      mesh.vertices.push_back(p);
    }
    return it->second;
  }

  TriangleMesh mesh;

 private:
  std::map<std::array<double, 3>, int> index_;
};

template <typename T>
T little_endian(const char* bytes) {
  std::array<char, sizeof(T)> copy{};
  std::memcpy(copy.data(), bytes, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) {
    std::reverse(copy.begin(), copy.end());
  }
  return std::bit_cast<T>(copy);
}

bool is_binary(const std::string& content) {
  if (content.size() < binary_header) {
    return false;
  }
  const auto facets = little_endian<std::uint32_t>(content.data() + 80);
  return content.size() - binary_header == std::uint64_t{facets} * binary_facet;
}

TriangleMesh parse_binary(const std::filesystem::path& file, const std::string& content) {
  Soup soup;
  const std::size_t facets = (content.size() - binary_header) / binary_facet;
  soup.mesh.triangles.reserve(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const char* corner = content.data() + binary_header + f * binary_facet + 12;
    std::array<int, 3> triangle{};
    for (int& vertex : triangle) {
      const Eigen::Vector3d p(little_endian<float>(corner), little_endian<float>(corner + 4),
                              little_endian<float>(corner + 8));
      if (!p.allFinite()) {
        throw MeshFileError(file.string() + ": facet " + std::to_string(f) +
                            ": found a coordinate that is not finite, expected finite numbers");
      }
      vertex = soup.vertex(p);
      corner += 12;
    }
    soup.mesh.triangles.push_back(triangle);
  }
  return std::move(soup.mesh);
}

TriangleMesh parse_ascii(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '\0');
  Soup soup;
  text.word("solid");
  text.skip_line();
  while (text.peek() == "facet") {
    text.word("facet");
    text.skip_line();
    text.word("outer");
    text.word("loop");
    std::array<int, 3> triangle{};
    for (int& vertex : triangle) {
      text.word("vertex");
      vertex = soup.vertex(text.point());
    }
    soup.mesh.triangles.push_back(triangle);
    text.word("endloop");
    text.word("endfacet");
  }
  text.word("endsolid");
  return std::move(soup.mesh);
}

}  // namespace

TriangleMesh parse_stl(const std::filesystem::path& file, std::string content) {
  if (is_binary(content)) {
    return parse_binary(file, content);
  }
  if (content.find_first_not_of(" \t\r\n") != content.find("solid")) {
    throw MeshFileError(file.string() + ": found " + std::to_string(content.size()) +
                        " bytes that are neither, expected ascii STL beginning with \"solid\" or binary STL whose "
                        "facet count fits its length");
  }
  return parse_ascii(file, std::move(content));
}

std::string format_stl(const TriangleMesh& mesh) {
  std::string text = "solid surface\n";
  for (const auto& triangle : mesh.triangles) {
    const auto& a = mesh.vertices[triangle[0]];
    const Eigen::Vector3d normal =
        (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).stableNormalized();
    text += "facet normal ";
    append_point(text, normal);
    text += "\nouter loop\n";
    for (const int vertex : triangle) {
      text += "vertex ";
      append_point(text, mesh.vertices[vertex]);
      text += '\n';
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid surface\n";
}

}  // namespace greenloop
