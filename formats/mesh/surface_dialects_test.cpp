// Surfaces as other programs write them: each text here is the same cube.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/test_files.hpp"

using namespace greenloop;
using Eigen::Vector3d;

namespace {

const auto folder = scratch_folder("surface_dialects_test");

const std::vector<Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<std::array<int, 4>> sides{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                            {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

struct Read {
  TriangleMesh mesh;
  MeshNotes notes;
};

Read read(const std::string& name, const std::string& content) {
  write_file(folder / name, content);
  Read result;
  result.mesh = read_surface(folder / name, result.notes);
  return result;
}

double volume(const TriangleMesh& mesh) {
  double sixfold = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sixfold += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  return sixfold / 6;
}

void check_cube(const Read& result, std::size_t notes = 0) {
  CHECK(result.mesh.vertices.size() == 8);
  CHECK(result.mesh.triangles.size() == 12);
  CHECK(volume(result.mesh) == doctest::Approx(1));
  CHECK(result.notes.size() == notes);
}

std::string text(const Vector3d& p, const std::string& more = "") {
  std::string line;
  append_point(line, p);
  return line + more + "\n";
}

std::string vertices(const std::string& before, const std::string& more = "") {
  std::string lines;
  for (const auto& corner : corners) lines += before + text(corner, more);
  return lines;
}

std::string faces(const std::string& before, int first, const std::string& more = "") {
  std::string lines;
  for (const auto& side : sides) {
    lines += before;
    for (const int corner : side) lines.append(" ").append(std::to_string(corner + first));
    lines += more + "\n";
  }
  return lines;
}

std::string replaced(std::string content, const std::string& from, const std::string& to) {
  for (std::size_t at = content.find(from); at != std::string::npos; at = content.find(from, at + to.size())) {
    content.replace(at, from.size(), to);
  }
  return content;
}

std::string upper(std::string content) {
  for (char& c : content) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c);
  return content;
}

std::string facets(std::size_t begin, std::size_t end) {
  std::string lines;
  for (std::size_t side = begin; side < end; ++side) {
    for (const auto& [i, j, k] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      lines += " facet normal 0 0 0\n  outer loop\n";
      for (const int corner : {i, j, k}) lines += "   vertex " + text(corners[sides[side][corner]]);
      lines += "  endloop\n endfacet\n";
    }
  }
  return lines;
}

template <typename T>
void append_bytes(std::string& bytes, T value, std::endian order = std::endian::little) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

std::string binary_stl(std::size_t begin, std::size_t end) {
  std::string bytes("solid binary");
  bytes.resize(80, ' ');
  append_bytes(bytes, static_cast<std::uint32_t>(2 * (end - begin)));
  for (std::size_t side = begin; side < end; ++side) {
    for (const auto& [i, j, k] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      bytes.append(12, '\0');
      for (const int corner : {i, j, k}) {
        for (int axis = 0; axis < 3; ++axis) {
          append_bytes(bytes, static_cast<float>(corners[sides[side][corner]][axis]));
        }
      }
      bytes.append(2, '\0');
    }
  }
  return bytes;
}

const std::string obj = vertices("v ") + faces("f", 1);
const std::string off = "OFF\n8 6 0\n" + vertices("") + faces("4", 0);
const std::string stl = "solid a cube\n" + facets(0, 6) + "endsolid a cube\n";

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment x\nobj_info y\nelement vertex 8\nproperty float x\nproperty float y\n"
         "property float z\nproperty float quality\nproperty list uchar float weights\nelement face 6\n"
         "property list int int vertex_indices\nend_header\n";
}

const std::string ply = ply_header("ascii") + vertices("", " nan 2 -inf inf") + faces("4", 0);

std::string binary_ply(std::endian order) {
  std::string bytes = ply_header(order == std::endian::big ? "binary_big_endian" : "binary_little_endian");
  for (const auto& corner : corners) {
    for (int axis = 0; axis < 3; ++axis) append_bytes(bytes, static_cast<float>(corner[axis]), order);
    append_bytes(bytes, std::bit_cast<float>(0x7fc00000U), order);
    append_bytes(bytes, std::uint8_t{1}, order);
    append_bytes(bytes, 1.0F, order);
  }
  for (const auto& side : sides) {
    append_bytes(bytes, std::int32_t{4}, order);
    for (const int corner : side) append_bytes(bytes, std::int32_t{corner}, order);
  }
  return bytes;
}

std::string vtk_header(const std::string& version, const std::string& encoding) {
  return "# vtk DataFile Version " + version + "\ncube\n" + encoding + "\nDATASET POLYDATA\n";
}

std::string binary_vtk() {
  std::string bytes = vtk_header("3.0", "BINARY") + "POINTS 8 float\n";
  for (const auto& corner : corners) {
    for (int axis = 0; axis < 3; ++axis) append_bytes(bytes, static_cast<float>(corner[axis]), std::endian::big);
  }
  bytes += "\nPOLYGONS 6 30\n";
  for (const auto& side : sides) {
    append_bytes(bytes, std::int32_t{4}, std::endian::big);
    for (const int corner : side) append_bytes(bytes, std::int32_t{corner}, std::endian::big);
  }
  return bytes + "\nPOINT_DATA 8\n";
}

const std::string byte_order_mark = "\xef\xbb\xbf";

}  // namespace

TEST_CASE("every text: Windows and old Macintosh line ends, a byte order mark, upper-case keywords and extensions") {
  const std::vector<std::pair<std::string, std::string>> files{
      {"c.obj", obj},
      {"c.off", off},
      {"c.stl", stl},
      {"c.ply", ply},
      {"c.vtk", vtk_header("3.0", "ASCII") + "POINTS 8 float\n" + vertices("") + "POLYGONS 6 30\n" + faces("4", 0)}};
  for (const auto& file : files) {
    const std::string &name = file.first, &content = file.second;
    CAPTURE(name);
    check_cube(read(name, content));
    check_cube(read(upper(name), content));
    check_cube(read(name, replaced(content, "\n", "\r\n")));
    check_cube(read(name, replaced(content, "\n", "\r")));
    check_cube(read(name, byte_order_mark + content));
    if (name != "c.vtk" && name != "c.ply") check_cube(read(name, upper(content)));
    check_refused([&] { return read(name, "\xff\xfeu").mesh; }, "UTF-16");
  }
}

TEST_CASE("STL: all solids are read") {
  check_cube(read("a.stl", "solid a\n" + facets(0, 2) + "endsolid a\nsolid b\n" + facets(2, 5) +
                               "endsolid b\n\nsolid\n" + facets(5, 6) + "endsolid\n"));
  check_cube(read("a.stl", binary_stl(0, 2) + binary_stl(2, 6)));
}

TEST_CASE("STL: words in two, everything on one line, colours, polygons") {
  auto words =
      replaced(replaced(replaced(stl, "endsolid", "end solid"), "endloop", "end loop"), "endfacet", "end facet");
  check_cube(read("a.stl", words));
  check_cube(read("a.stl", replaced(stl, "\n", " ")));
  check_cube(read("a.stl", replaced(stl, " facet", " color 1 0 0\n facet")));
  check_cube(read("a.stl", replaced(stl, "normal 0 0 0", "normal nan nan -nan(ind)")));
  check_cube(read("a.stl", replaced(stl, "solid a cube", "solid a facet of facet s")));
  std::string quads = "solid\n";
  for (const auto& side : sides) {
    quads += "facet normal 0 0 0 outer loop\n";
    for (const int corner : side) quads += "vertex " + text(corners[corner]);
    quads += "endloop endfacet\n";
  }
  check_cube(read("a.stl", quads + "endsolid\n"));
}

TEST_CASE("STL: what follows the end is harmless, noted or refused, never dropped in silence") {
  check_cube(read("a.stl", stl + std::string(3, '\0') + "\x1a\r\n"));
  check_cube(read("a.stl", stl + "written by hand\n"), 1);
  check_refused([] { return read("a.stl", stl + "and\n" + facets(0, 1)).mesh; }, "found \"and\", expected \"solid\"");
  check_refused([] { return read("a.stl", stl + facets(0, 1)).mesh; }, "found \"facet\", expected \"solid\"");
  check_cube(read("a.stl", binary_stl(0, 6) + "\r\n"));
  check_cube(read("a.stl", binary_stl(0, 6) + std::string(428, '\0')));
  const auto noted = read("a.stl", binary_stl(0, 6) + "made by x");
  check_cube(noted, 1);
  CHECK(noted.notes[0].ends_with("a.stl: 9 bytes behind the last facet skipped"));
  auto few = binary_stl(0, 6);
  few[80] = 10;
  check_refused([&] { return read("a.stl", few).mesh; },
                "100 bytes behind the last facet, as long as 2 facets, expected no more than the 10");
}

TEST_CASE("OBJ: continued lines, faces before their vertices, relative ones, unknown words") {
  check_cube(read("a.obj", vertices("v ") + replaced(faces("f", 1), " 3", " \\\n3")));
  check_cube(read("a.obj", vertices("v ") + replaced(faces("f", 1), " 3", "\\ \r\n  3")));
  check_cube(read("a.obj", vertices("v ", "\\\n 1 0 0") + "g a\\\nb\ns off\n" + faces("f", 1)));
  check_cube(read("a.obj", faces("f", 1) + vertices("v ")));
  check_cube(read("a.obj", vertices("v ") + faces("f", -8)));
  check_cube(read("a.obj", vertices("v ", " 0.1 0.2 0.3 1") + "vt 0 0\nvn 0 0 1\nl 1 2\np 1\n" +
                               replaced(faces("f", 1), " 3", " 3/1/1")));
  const auto unknown = read("a.obj", obj + "curv 0 1 1 2\ncurv 0 1 2 3\n");
  check_cube(unknown, 1);
  CHECK(unknown.notes[0].find("2 lines of unknown keywords skipped, the first \"curv\" on line 15") !=
        std::string::npos);
  check_refused([] { return read("a.obj", "f 1 2 4\n" + vertices("v ").substr(0, 24)).mesh; }, "a.obj:1: found \"4\"");
}

TEST_CASE("OFF: colours without a word, prefixes, no header, all on one line, a rest") {
  check_cube(read("a.off", "OFF\n8 6 0\n" + vertices("", " 255 0 0 255") + faces("4", 0, " 0.5 0.5 0.5")));
  for (const std::string prefix : {"C", "N", "CN", "ST", "STCN", "c"}) {
    CAPTURE(prefix);
    check_cube(read("a.off", prefix + "OFF\n8 6\n" + vertices("", " 1 2 3") + faces("4", 0)));
  }
  check_cube(read("a.off", off.substr(4)));
  check_cube(read("a.off", replaced(off, "\n", " ")));
  check_cube(read("a.off", off + "# the end\n"));
  check_cube(read("a.off", replaced(off, "8 6 0", "8 8 0") + "2 0 1\n1 7\n"), 1);
  check_cube(read("a.off", off + "4 0 1 2 3\n"), 1);
  check_refused([] { return read("a.off", replaced(off, "OFF", "4OFF")).mesh; }, "found \"4OFF\"");
}

TEST_CASE("PLY: unused values that are no numbers, both byte orders, faces before vertices, strips, a rest") {
  check_cube(read("a.ply", ply));
  check_cube(read("a.ply", binary_ply(std::endian::little)));
  check_cube(read("a.ply", binary_ply(std::endian::big)));
  check_cube(read("a.ply", ply + "1 2 3\n"), 1);
  const auto strips =
      read("a.ply",
           "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex 8\n"
           "property float x\nproperty float y\nproperty float z\nend_header\n"
           "29 0 3 1 2 -1 4 5 7 6 -1 0 1 4 5 -1 1 2 5 6 -1 2 3 6 7 -1 3 0 7 4\n" +
               vertices(""));
  check_cube(strips);
}

TEST_CASE("VTK: binary, version 5, strips, other cells and fields before") {
  check_cube(read("a.vtk", binary_vtk()));
  std::string offsets = "0", connectivity;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    offsets.append(" ").append(std::to_string(4 * (side + 1)));
    for (const int corner : sides[side]) connectivity += std::to_string(corner) + " ";
  }
  check_cube(read(
      "a.vtk", vtk_header("5.1", "ASCII") + "FIELD FieldData 1\nTIME 1 1 double\n0.5\nPOINTS 8 double\n" +
                   vertices("") + "METADATA\nINFORMATION 0\n\nLINES 1 3\n2 0 1\nPOLYGONS 7 24\nOFFSETS vtktypeint64\n" +
                   offsets + "\nCONNECTIVITY vtktypeint64\n" + connectivity + "\nCELL_DATA 6\nSCALARS a int\n"));
  check_cube(
      read("a.vtk", vtk_header("3.0", "ASCII") + "POINTS 8 float\n" + vertices("") +
                        "TRIANGLE_STRIPS 6 30\n4 0 3 1 2\n4 4 5 7 6\n4 0 1 4 5\n4 1 2 5 6\n4 2 3 6 7\n4 3 0 7 4\n"));
  check_refused([] { return read("a.vtk", binary_vtk().substr(0, 150)).mesh; }, "bytes of numbers");
}

TEST_CASE("numbers: Fortran exponents, too small ones, plus signs") {
  check_cube(read("a.off", replaced(off, "1 1 0\n", "1.0D+00 +1d0 1e-400\n")));
}

TEST_CASE("refused before they are read: folders, pipes, devices, files too long") {
  std::filesystem::create_directories(folder / "d.off");
  check_refused([] { return read_surface(folder / "d.off"); }, "d.off: found a folder, expected a file");
  REQUIRE(mkfifo((folder / "p.off").c_str(), 0600) == 0);
  check_refused([] { return read_surface(folder / "p.off"); }, "p.off: found a pipe, expected a file");
  std::filesystem::create_symlink("/dev/zero", folder / "z.off");
  check_refused([] { return read_surface(folder / "z.off"); }, "z.off: found a device or socket, expected a file");
  write_file(folder / "l.off", "OFF");
  std::filesystem::resize_file(folder / "l.off", largest_mesh_file + 1);  // a hole, no blocks
  check_refused([] { return read_surface(folder / "l.off"); }, "found 2147483649 bytes, expected at most 2147483648");
  std::filesystem::remove(folder / "l.off");
  check_refused([] { return read("e.off", "").mesh; }, "found the end of the file");
}

TEST_CASE("damaged files are read or refused, never worse; seeds 1 to 6") {
  const auto check = [&](const std::string& good, std::uint64_t seed, auto parse) {
    CAPTURE(seed);
    CHECK(count_refused_mutants(good, seed, 4000, [&](const std::string& bad) {
            MeshNotes notes;
            return triangulate("a", parse("a", bad, notes), notes);
          }) > 200);
  };
  check(obj, 1, parse_obj);
  check(off, 2, parse_off);
  check(binary_stl(0, 6), 3, parse_stl);
  check(binary_ply(std::endian::big), 4, parse_ply);
  check(binary_vtk(), 5, parse_vtk_surface);
  check(stl, 6, parse_stl);
}
