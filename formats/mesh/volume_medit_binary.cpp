// Medit (INRIA), binary, as libMeshb writes it: the int 1, which tells the byte order, and the version; then keywords,
// each an int and the place where the next one stands, "Dimension" first. Version 1 has floats; 3 on has places of 8
// bytes, 4 on also counts and numbers.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "formats/mesh/binary_scalar.hpp"
#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr std::int64_t dimension = 3, vertices = 4, tetrahedra = 8, end = 54;

// what is in the keyword's place, of volumes other than linear tetrahedra
struct OtherVolume {
  std::int64_t keyword;
  std::string_view name;
};
constexpr std::array<OtherVolume, 17> other_volumes{{{9, "prisms"},
                                                     {10, "hexahedra"},
                                                     {30, "tetrahedra of degree 2"},
                                                     {33, "hexahedra of degree 2"},
                                                     {46, "polyhedra"},
                                                     {49, "pyramids"},
                                                     {86, "prisms of degree 2"},
                                                     {87, "pyramids of degree 2"},
                                                     {96, "tetrahedra of degree 3"},
                                                     {97, "tetrahedra of degree 4"},
                                                     {98, "hexahedra of degree 3"},
                                                     {99, "hexahedra of degree 4"},
                                                     {100, "pyramids of degree 3"},
                                                     {101, "pyramids of degree 4"},
                                                     {102, "prisms of degree 3"},
                                                     {103, "prisms of degree 4"},
                                                     {207, "polyhedra"}}};

struct MeditPart {
  std::size_t begin = 0, end = 0;
};

class MeditBytes {
 public:
  MeditBytes(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {
    order_ = bytes.front() == '\1' ? std::endian::little : std::endian::big;
    at_ = 4;
    version_ = next(Scalar::i32);
    if (version_ < 1 || version_ > 4) fail("version " + std::to_string(version_), "version 1 to 4");
  }

  /// A part of a file, which is read from its beginning and not beyond its end.
  MeditBytes(const MeditBytes& whole, const MeditPart& part) : MeditBytes(whole) {
    at_ = part.begin;
    bytes_ = bytes_.substr(0, part.end);
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw MeshFileError(file_.string() + ": found " + found + " at byte " + std::to_string(at_) + ", expected " +
                        expected);
  }

  std::int64_t next_word() { return next(Scalar::i32); }
  std::int64_t next_place() { return next(version_ < 3 ? Scalar::i32 : Scalar::i64); }
  std::int64_t next_number() { return next(version_ < 4 ? Scalar::i32 : Scalar::i64); }

  Eigen::Vector3d next_point() {
    Eigen::Vector3d point;
    for (double& coordinate : point) {
      const Scalar type = version_ < 2 ? Scalar::f32 : Scalar::f64;
      coordinate = decode(type, take(size_of(type)), order_);
    }
    if (!point.allFinite()) fail("a coordinate that is not finite", "finite coordinates");
    return point;
  }

  /// A number of items of a vertex's three coordinates and reference, or of a tetrahedron's five numbers.
  std::size_t next_count(std::string_view items, std::size_t bytes_each) {
    const auto count = next_number();
    if (count < 0 || static_cast<std::uint64_t>(count) > (bytes_.size() - at_) / bytes_each) {
      fail(std::to_string(count) + " " + std::string(items),
           "as many as fit the " + std::to_string(bytes_.size() - at_) + " bytes of the section");
    }
    return static_cast<std::size_t>(count);
  }

  [[nodiscard]] std::size_t number_bytes() const { return version_ < 4 ? 4 : 8; }
  [[nodiscard]] std::size_t point_bytes() const { return version_ < 2 ? 12 : 24; }

  /// From here to the next section, or to the end of the file if `next` is 0.
  [[nodiscard]] MeditPart part_to(std::int64_t next) const {
    if (next != 0 && (next < static_cast<std::int64_t>(at_) || static_cast<std::uint64_t>(next) > bytes_.size())) {
      fail("the next section at byte " + std::to_string(next),
           "a place behind this one, in the " + std::to_string(bytes_.size()) + " bytes of the file");
    }
    return {at_, next == 0 ? bytes_.size() : static_cast<std::size_t>(next)};
  }
  void go_to(std::size_t place) { at_ = place; }

 private:
  std::int64_t next(Scalar type) {
    const char* const bytes = take(size_of(type));
    return type == Scalar::i32 ? decode_as<std::int32_t>(bytes, order_) : decode_as<std::int64_t>(bytes, order_);
  }

  const char* take(std::size_t count) {
    if (count > bytes_.size() - at_) fail("the end of the section", std::to_string(count) + " bytes more");
    at_ += count;
    return bytes_.data() + at_ - count;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::endian order_ = std::endian::little;
  std::int64_t version_ = 0;
};

void refuse_other_volumes(MeditBytes& bytes, std::int64_t keyword) {
  const auto* const other = std::find_if(other_volumes.begin(), other_volumes.end(),
                                         [&](const OtherVolume& known) { return known.keyword == keyword; });
  if (other != other_volumes.end() && bytes.next_number() != 0) {
    bytes.fail(std::string(other->name), "linear tetrahedra only");
  }
}

/// Of sections of vertices and of tetrahedra: from the count to where the next one begins.
struct Sections {
  std::vector<MeditPart> vertices, tetrahedra;
};

Sections find_sections(MeditBytes& bytes) {
  if (const auto keyword = bytes.next_word(); keyword != dimension) {
    bytes.fail("keyword " + std::to_string(keyword), "the dimension (keyword 3)");
  }
  auto next = bytes.next_place();
  if (const auto found = bytes.next_word(); found != 3) bytes.fail("dimension " + std::to_string(found), "dimension 3");
  Sections sections;
  while (next != 0) {
    bytes.go_to(bytes.part_to(next).end);
    const auto keyword = bytes.next_word();
    if (keyword == end) break;
    next = bytes.next_place();
    const MeditPart part = bytes.part_to(next);
    if (keyword == vertices) sections.vertices.push_back(part);
    if (keyword == tetrahedra) sections.tetrahedra.push_back(part);
    refuse_other_volumes(bytes, keyword);
  }
  return sections;
}

void read_vertices(MeditBytes bytes, VolumeBuilder& builder) {
  std::vector<Eigen::Vector3d> positions(bytes.next_count("vertices", bytes.point_bytes() + bytes.number_bytes()));
  for (auto& position : positions) {
    position = bytes.next_point();
    static_cast<void>(bytes.next_number());
  }
  builder.add_nodes(positions);
}

void read_tetrahedra(MeditBytes bytes, VolumeBuilder& builder) {
  const auto count = bytes.next_count("tetrahedra", 5 * bytes.number_bytes());
  for (std::size_t i = 0; i < count; ++i) {
    std::array<int, 4> nodes{};
    for (int& node : nodes) {
      const auto number = bytes.next_number();
      if (number < 1 || static_cast<std::uint64_t>(number) > builder.node_count()) {
        bytes.fail("vertex " + std::to_string(number), "1 to " + std::to_string(builder.node_count()));
      }
      node = static_cast<int>(number - 1);
    }
    static_cast<void>(bytes.next_number());
    builder.add_tetrahedron(nodes, 0);
  }
}

}  // namespace

VolumeBuilder parse_binary_medit(const std::filesystem::path& file, std::string_view content) {
  MeditBytes bytes(file, content);
  const auto sections = find_sections(bytes);
  VolumeBuilder builder(file);
  for (const MeditPart& part : sections.vertices) {
    read_vertices(MeditBytes(bytes, part), builder);
  }
  for (const MeditPart& part : sections.tetrahedra) {
    read_tetrahedra(MeditBytes(bytes, part), builder);
  }
  return builder;
}

}  // namespace greenloop
