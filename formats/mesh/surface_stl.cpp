// Stereolithography: a soup of facets. Binary: 80 bytes, uint32 count, then 50 bytes each; ascii: "solid".
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/binary_scalar.hpp"
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

  PolygonMesh mesh;

 private:
  std::map<std::array<double, 3>, int> index_;
};

template <typename T>
T little_endian(const char* bytes) {
  return decode_as<T>(bytes, std::endian::little);
}

/// Facets that a header counts, if the bytes hold that many.
std::optional<std::size_t> counted_facets(std::string_view bytes) {
  if (bytes.size() < binary_header) {
    return std::nullopt;
  }
  const std::size_t facets = little_endian<std::uint32_t>(bytes.data() + 80);
  return (bytes.size() - binary_header) / binary_facet >= facets ? std::optional(facets) : std::nullopt;
}

void read_facet(const std::filesystem::path& file, const char* corner, Soup& soup) {
  std::array<int, 3> triangle{};
  for (int& vertex : triangle) {
    const Eigen::Vector3d p(little_endian<float>(corner), little_endian<float>(corner + 4),
                            little_endian<float>(corner + 8));
    if (!p.allFinite()) {
      throw MeshFileError(file.string() + ": facet " + std::to_string(soup.mesh.size()) +
                          ": found a coordinate that is not finite, expected finite numbers");
    }
    vertex = soup.vertex(p);
    corner += 12;
  }
  soup.mesh.add(triangle, 0);
}

/// What follows the facets that were counted: facets that were not are refused, anything else is noted.
void judge_rest(const std::filesystem::path& file, std::string_view rest, std::size_t facets, MeshNotes& notes) {
  const auto found = file.string() + ": " + std::to_string(rest.size()) + " bytes behind the last facet";
  if (rest.find_first_not_of(std::string_view("\0\x1a\r\n\t ", 6)) == std::string_view::npos) {
    return;
  }
  if (rest.size() % binary_facet == 0) {
    throw MeshFileError(found + ", as long as " + std::to_string(rest.size() / binary_facet) +
                        " facets, expected no more than the " + std::to_string(facets) + " that the header counts");
  }
  notes.push_back(found + " skipped");
}

/// Several files one behind the other are several solids.
PolygonMesh parse_binary(const std::filesystem::path& file, std::string_view content, MeshNotes& notes) {
  Soup soup;
  for (auto facets = counted_facets(content); facets.value_or(0) > 0; facets = counted_facets(content)) {
    for (std::size_t f = 0; f < *facets; ++f) {
      read_facet(file, content.data() + binary_header + f * binary_facet + 12, soup);
    }
    content.remove_prefix(binary_header + *facets * binary_facet);
  }
  judge_rest(file, content, soup.mesh.size(), notes);
  return std::move(soup.mesh);
}

/// Takes the word, whole or in two ("endfacet", "end facet").
void take_end(MeshText& text, std::string_view what) {
  if (same_word(text.peek(), "end")) {
    text.word("end");
    text.word(what);
  } else {
    text.word("end" + std::string(what));
  }
}

/// "facet normal"; a name may hold "facet" alone.
bool begins_facet(std::string_view text) {
  if (!same_word(text.substr(0, 5), "facet")) return false;
  const auto next = std::min(text.find_first_not_of(" \t\r\n", 5), text.size());
  return next > 5 && same_word(text.substr(next, 6), "normal");
}

/// "solid" and a name, up to the end of the line or a facet on it.
void take_solid(MeshText& text) {
  text.word("solid");
  while (text.more_on_line() && !begins_facet(text.rest())) {
    static_cast<void>(text.token("a name"));
  }
}

/// "facet normal x y z"; the normal is not looked at.
void take_facet(MeshText& text) {
  text.word("facet");
  for (int i = 0; i < 4 && !same_word(text.peek(), "outer"); ++i) {
    static_cast<void>(text.token("\"normal\" and three numbers"));
  }
}

void read_ascii_facet(MeshText& text, Soup& soup) {
  take_facet(text);
  text.word("outer");
  text.word("loop");
  std::vector<int> corners;
  while (corners.size() < 3 || same_word(text.peek(), "vertex")) {
    text.word("vertex");
    corners.push_back(soup.vertex(text.point()));
  }
  soup.mesh.add(corners, text.line_number());
  take_end(text, "loop");
  take_end(text, "facet");
}

bool begins_end(std::string_view word) { return same_word(word, "endsolid") || same_word(word, "end"); }

bool holds_facet(std::string_view bytes) {
  constexpr std::string_view word = "facet";
  for (std::size_t at = 0; at + word.size() <= bytes.size(); ++at) {
    if (same_word(bytes.substr(at, word.size()), word)) {
      return true;
    }
  }
  return false;
}

/// Solids up to the end of the file; behind the last one only what holds no facet.
PolygonMesh parse_ascii(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  MeshText text(file, std::move(content), '\0');
  Soup soup;
  do {
    take_solid(text);
    while (!begins_end(text.peek())) {
      if (same_word(text.peek(), "color")) {
        text.skip_line();
      } else {
        read_ascii_facet(text, soup);
      }
    }
    take_end(text, "solid");
    text.skip_line();
  } while (same_word(text.peek(), "solid"));
  if (!text.at_end() && holds_facet(text.rest())) {
    text.word("solid");
  }
  text.note_rest(notes, "solid");
  return std::move(soup.mesh);
}

}  // namespace

PolygonMesh parse_stl(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  if (counted_facets(content).value_or(0) > 0) {
    return parse_binary(file, content, notes);
  }
  MeshText head(file, content.substr(0, 256), '\0');
  if (!content.empty() && !same_word(head.peek(), "solid")) {
    throw MeshFileError(file.string() + ": found " + std::to_string(content.size()) +
                        " bytes that are neither, expected ascii STL beginning with \"solid\" or binary STL whose "
                        "facet count fits its length");
  }
  return parse_ascii(file, std::move(content), notes);
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
