#include "formats/mesh/surface_io.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/test_files.hpp"

using namespace greenloop;
using Eigen::Vector3d;

namespace {

const auto folder = scratch_folder("surface_io_test");

/// Coordinates whose decimal forms are long, a subnormal and a negative zero among them.
TriangleMesh awkward() {
  return {{{0.1, 1.0 / 3, -2e-308}, {1e300, 5e-324, 0}, {-1.0000000000000002, 12345678.9, 7}, {3, 4, 5}},
          {{0, 1, 2}, {2, 1, 3}}};
}

void check_same(const TriangleMesh& a, const TriangleMesh& b) {
  CHECK(a.vertices == b.vertices);
  CHECK(a.triangles == b.triangles);
}

TriangleMesh read_text(const std::string& name, std::string_view text) {
  write_file(folder / name, text);
  return read_surface(folder / name);
}

void refuse(const std::string& name, std::string_view text, std::string_view piece) {
  check_refused([&] { return read_text(name, text); }, piece);
}

template <typename T>
void append_bytes(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

std::string binary_stl(const std::vector<std::array<Vector3d, 3>>& facets) {
  std::string bytes(80, 's');
  append_bytes(bytes, static_cast<std::uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    bytes.append(12, '\0');
    for (const auto& corner : facet) {
      for (int i = 0; i < 3; ++i) {
        append_bytes(bytes, static_cast<float>(corner[i]));
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

const std::string ply_header =
    "format binary_little_endian 1.0\ncomment with words\nelement vertex 4\nproperty float x\nproperty double y\n"
    "property uchar red\nproperty short z\nelement edge 1\nproperty list ushort float lengths\nelement face 1\n"
    "property uchar flags\nproperty list uchar uint vertex_index\nend_header\n";

std::string binary_ply() {
  std::string bytes = "ply\n" + ply_header;
  for (int v = 0; v < 4; ++v) {
    append_bytes(bytes, static_cast<float>(v));
    append_bytes(bytes, 0.1 * v);
    append_bytes(bytes, std::uint8_t{255});
    append_bytes(bytes, static_cast<std::int16_t>(-v * v));
  }
  append_bytes(bytes, std::uint16_t{2});
  append_bytes(bytes, 1.0F);
  append_bytes(bytes, 2.0F);
  append_bytes(bytes, std::uint8_t{7});
  append_bytes(bytes, std::uint8_t{4});
  for (const std::uint32_t v : {0U, 1U, 2U, 3U}) {
    append_bytes(bytes, v);
  }
  return bytes;
}

const std::string ascii_stl =
    "solid two words\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n  "
    "endloop\n "
    "endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 1 0 -0.0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n "
    "endfacet\nendsolid two words\n";

}  // namespace

TEST_CASE("what is written reads back bit by bit") {
  for (const auto* name : {"a.off", "a.obj", "a.ply"}) {
    CAPTURE(name);
    write_surface(folder / name, awkward());
    check_same(read_surface(folder / name), awkward());
  }
}

TEST_CASE("STL reads back the same positions") {
  const TriangleMesh mesh{{{0.1, 0, 0}, {1, 1.0 / 3, 0}, {0, 1, 0}, {0, 1, 1}}, {{0, 1, 2}, {2, 1, 3}}};
  write_surface(folder / "a.stl", mesh);
  check_same(read_surface(folder / "a.stl"), mesh);
}

TEST_CASE("OFF: comments, blank lines, colours, polygons, no count of edges") {
  const auto mesh = read_text("a.off",
                              "# first\nOFF # second\n\n5 2\n0 0 0\n1 0 0\n1 1 0\n\n0 1 0 # corner\n9 9 9\n"
                              "4 0 1 2 3 255 0 0\n3  0 2 +4 0.5 0.5 0.5 1\n");
  check_same(mesh, {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}}, {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}});
}

TEST_CASE("OFF: counts behind the header, Windows line ends") {
  CHECK(read_text("a.off", "OFF 3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n").triangles.size() == 1);
}

TEST_CASE("COFF: colours of vertices are skipped") {
  const auto mesh = read_text("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 1 2 3 4\n0 1 0 5 6 7 8\n3 0 1 2\n");
  check_same(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
}

TEST_CASE("OBJ: all forms of face corners, negative indices, other keywords") {
  const auto mesh = read_text("a.OBJ",
                              "mtllib a.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0\nvt 0 0\nvn 0 0 1\nv 1 1 0 0.5 0.5 0.5\n"
                              "g part # comment\nf 1/1/1 2//1 3/1\nv 0 1 0\nf -4 -2 -1\ns off\nf 1 2 3 4\n");
  check_same(mesh, {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}}});
}

TEST_CASE("STL: ascii vertices are merged, zeros of both signs too") {
  const auto mesh = read_text("a.stl", ascii_stl);
  check_same(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}});
}

TEST_CASE("STL: binary, even if it begins with solid") {
  auto bytes = binary_stl({{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)},
                           {Vector3d(1, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0)}});
  bytes.replace(0, 5, "solid");
  check_same(read_text("a.stl", bytes), {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}});
}

TEST_CASE("PLY: ascii") {
  const auto mesh = read_text("a.ply",
                              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                              "property float z\nproperty uchar red\nelement face 1\n"
                              "property list uchar int vertex_indices\nend_header\n"
                              "0 0 0 255\n1 0 0 255\n0 1 0.5 0\n3 0 1 2\n");
  check_same(mesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}, {{0, 1, 2}}});
}

TEST_CASE("PLY: binary with other properties and elements between") {
  const auto mesh = read_text("a.ply", binary_ply());
  check_same(mesh, {{{0, 0, 0}, {1, 0.1, -1}, {2, 0.2, -4}, {3, 0.1 * 3, -9}}, {{0, 1, 2}, {0, 2, 3}}});
}

TEST_CASE("files that others wrote") {
  CHECK(read_surface(fetched("meshes/bear_bis.off")).triangles.size() == 20188);
  CHECK(read_surface(fetched("bunny.obj")).triangles.size() == 3674);
  CHECK(read_surface(fetched("meshes/mesh_with_colors.off")).vertices.size() > 3);
  CHECK(read_surface(fetched("meshes/sphere.ply")).triangles.size() > 100);
  CHECK(read_surface(fetched("meshes/colored_tetra.ply")).triangles.size() == 4);
  const auto pig = read_surface(fetched("meshes/pig.stl"));
  CHECK(pig.triangles.size() == 16848);
  CHECK(pig.vertices.size() == 8642);
  check_refused([] { return read_surface(fetched("meshes/b9.ply")); }, "b9.ply: found no face");
}

TEST_CASE("the surface of tetrahedra is their boundary, however they are oriented") {
  const std::string nodes =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "5 1 1 1\n$EndNodes\n$Elements\n3\n";
  const std::string face = "1 2 2 0 1 2 3 4\n";
  for (const char* second : {"2 3 4 5", "2 4 3 5"}) {
    write_file(folder / "two.msh", nodes + face + "2 4 2 0 1 1 2 3 4\n3 4 2 0 1 " + second + "\n$EndElements\n");
    MeshNotes notes;
    const auto mesh = read_surface(folder / "two.msh", notes);
    CHECK(mesh.vertices.size() == 5);
    CHECK(mesh.triangles.size() == 6);
    for (auto triangle : mesh.triangles) {
      std::sort(triangle.begin(), triangle.end());
      CHECK(triangle != std::array{1, 2, 3});  // the inner face, though the file lists it
    }
    CHECK(notes == MeshNotes{"the boundary of 2 tetrahedra taken"});
  }
}

TEST_CASE("cells without tetrahedra are a surface of their triangles and quadrilaterals") {
  const TriangleMesh expected{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}};
  const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n";
  check_same(read_text("a.msh",
                       "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n$ENDNOD\n$ELM\n3\n"
                       "1 3 1 1 4 1 2 3 4\n2 2 1 1 3 1 2 5\n3 15 1 1 1 4\n$ENDELM\n"),
             expected);
  check_same(
      read_text("b.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 5\n2 1 0 5\n1\n2\n3\n4\n5\n" + corners +
                             "$EndNodes\n$Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n2 1 2 1\n2 1 2 5\n"
                             "$EndElements\n"),
      expected);
  check_same(read_text("a.mesh",
                       "MeshVersionFormatted 1\nDimension 3\nVertices\n5\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n"
                       "0 0 1 1\nQuadrilaterals\n1\n1 2 3 4 7\nTriangles\n1\n1 2 5 7\nEnd\n"),
             expected);
  check_same(read_text("a.vtk", "# vtk DataFile Version 3.0\nany\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n" +
                                    corners + "CELLS 3 11\n4 0 1 2 3\n3 0 1 4\n1 2\nCELL_TYPES 3\n9\n5\n1\n"),
             expected);
  refuse("b.vtk",
         "# vtk DataFile Version 3.0\nany\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 2\n"
         "1 0\nCELL_TYPES 1\n1\n",
         "b.vtk: found no face");
}

TEST_CASE("refused: an unknown extension, with the supported ones") {
  check_refused([] { return read_surface("bear.step"); },
                "bear.step: found extension \".step\", expected a surface file: "
                ".off, .obj, .stl, .ply or .vtk");
  check_refused([] { return write_surface("bear", {}), 0; }, "found extension \"\"");
}

TEST_CASE("refused: a file that is not there, a folder, a folder to write to that is not there") {
  check_refused([] { return read_surface("no/such.off"); }, "no/such.off: no such file");
  check_refused([] { return read_surface("/.off"); }, "found extension \"\"");
  check_refused([] { return write_surface("no/such/folder/a.off", {}), 0; }, "cannot be written");
}

TEST_CASE("refused: a file without faces") {
  refuse("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "a.off: found no face");
  refuse("a.obj", "hello\n", "a.obj: found no face");
}

TEST_CASE("refused: OFF header") { refuse("a.off", "\n\nOOF\n3 1 0\n", "a.off:3: found \"OOF\", expected \"OFF\""); }

TEST_CASE("refused: OFF binary") {
  refuse("a.off", "OFF BINARY\n", "a.off:1: found \"BINARY\", expected an ascii OFF file");
}

TEST_CASE("refused: OFF empty") { refuse("a.off", "", "a.off:1: found the end of the file, expected \"OFF\""); }

TEST_CASE("refused: OFF counts that cannot be in the file") {
  refuse("a.off", "OFF\n2000000000 1 0\n0 0 0\n",
         "a.off:2: found \"2000000000\", expected the number of vertices that fits");
  refuse("a.off", "OFF\n99999999999999999999 1 0\n", "a.off:2: found \"99999999999999999999\"");
  refuse("a.off", "OFF\n-3 1 0\n", "a.off:2: found \"-3\", expected the number of vertices (a whole number, from 0");
  refuse("a.off", "OFF\n0 2000000000 0\n", "expected the number of faces that fits");
}

TEST_CASE("refused: OFF coordinates") {
  const auto with = [](const std::string& x) { return "OFF\n3 1 0\n0 0 0\n" + x + " 0 0\n0 1 0\n3 0 1 2\n"; };
  refuse("a.off", with("nan"), "a.off:4: found \"nan\", expected the x coordinate of a vertex (a finite number)");
  refuse("a.off", with("-inf"), "a.off:4: found \"-inf\"");
  refuse("a.off", with("1e999"), "a.off:4: found \"1e999\"");
  refuse("a.off", with("1,5"), "a.off:4: found \"1,5\"");
  refuse("a.off", with("0x10"), "a.off:4: found \"0x10\"");
}

TEST_CASE("refused: OFF indices") {
  const auto with = [](const std::string& face) { return "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" + face; };
  refuse("a.off", with("3 0 1 3\n"), "a.off:6: found \"3\", expected a vertex index (a whole number, from 0 to 2)");
  refuse("a.off", with("3 0 1 -1\n"), "a.off:6: found \"-1\"");
  refuse("a.off", with("3 0 1 1.5\n"), "a.off:6: found \"1.5\"");
  refuse("a.off", with("0 0 1    \n"), "a.off:6: found \"0\", expected the number of vertices of a face");
  refuse("a.off", with("3 0 1   "), "a.off:6: found the end of the file, expected a vertex index");
}

TEST_CASE("refused: OBJ indices") {
  const auto with = [](const std::string& face) { return "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + face + "\n"; };
  refuse("a.obj", with("1 2 4"), "a.obj:4: found \"4\", expected a vertex of a face (a whole number, 1 to 3, or");
  refuse("a.obj", with("0 1 2"), "a.obj:4: found \"0\"");
  refuse("a.obj", with("1 2 -4"), "a.obj:4: found \"-4\"");
  refuse("a.obj", with("1 2 /3"), "a.obj:4: found \"/3\"");
  refuse("a.obj", with("1 2 99999999999999999999"), "a.obj:4: found \"99999999999999999999\"");
  refuse("a.obj", with("1 2"), "a.obj:4: found \"f with 2 vertices\", expected a face of at least 3 vertices");
}

TEST_CASE("refused: OBJ coordinates") {
  refuse("a.obj", "v 0 0\nf 1 1 1\n", "a.obj:2: found \"f\", expected the z coordinate");
}

TEST_CASE("refused: STL neither ascii nor binary") {
  refuse("a.stl", "hello", "a.stl: found 5 bytes that are neither");
  refuse("a.stl", "", "a.stl:1: found the end of the file, expected \"solid\"");
  const auto one = binary_stl({{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)}});
  refuse("a.stl", one.substr(0, one.size() - 1), "that are neither");
  refuse("a.stl", one + std::string(50, 'x'), "50 bytes behind the last facet, as long as 1 facets");
}

TEST_CASE("refused: STL words and numbers") {
  auto text = ascii_stl;
  text.replace(text.find("outer"), 5, "inner");
  refuse("a.stl", text, "a.stl:3: found \"inner\", expected \"outer\"");
  refuse("a.stl", ascii_stl.substr(0, 100), "expected");
  text = ascii_stl;
  text.replace(text.find("1e0"), 3, "abc");
  refuse("a.stl", text, "a.stl:6: found \"abc\", expected the y coordinate");
}

TEST_CASE("refused: STL binary with a coordinate that is not finite") {
  auto bytes = binary_stl({{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)}});
  std::memset(bytes.data() + 84 + 12, 0xff, 4);
  refuse("a.stl", bytes, "a.stl: facet 0: found a coordinate that is not finite");
}

TEST_CASE("refused: PLY headers") {
  refuse("a.ply", "pli\n", "a.ply:1: found \"pli\", expected \"ply\"");
  refuse("a.ply", "ply\nformat binary 1.0\n", "a.ply:2: found \"binary\", expected format \"ascii\"");
  refuse("a.ply", "ply\nformat ascii 1.0\nproperty float x\n",
         "a.ply:3: found \"property\", expected an element before");
  refuse("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n",
         "a.ply:4: found \"half\", expected a property");
  refuse("a.ply", "ply\nformat ascii 1.0\nelement vertex 4000000\n",
         "a.ply:3: found \"4000000\", expected the number of el");
  refuse("a.ply", "ply\nformat ascii 1.0\nwhat\n", "a.ply:3: found \"what\", expected \"element\"");
  refuse("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nend_header\n",
         "found \"element vertex without property z\"");
  refuse("a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", "found \"element face without a list\"");
}

TEST_CASE("refused: PLY binary cut short, with a wrong index, with a long list") {
  const auto good = binary_ply();
  refuse("a.ply", good.substr(0, good.size() - 1), "a.ply: found the end of the file in the binary part");
  auto bad = good;
  bad[good.size() - 4] = 9;
  refuse("a.ply", bad, "found 9 in the binary part, expected a vertex index (a whole number from 0 to 3)");
  bad = good;
  bad[good.size() - 17] = 2;
  refuse("a.ply", bad, "found 2 in the binary part, expected at least 3 vertices of a face");
  bad[good.size() - 17] = 100;
  refuse("a.ply", bad, "found 100 in the binary part, expected the length of a list (a whole number from 0 to 17)");
}

TEST_CASE("damaged files are read or refused, never worse; seeds 1 to 5") {
  const TriangleMesh mesh = read_surface(fetched("meshes/tetrahedron.off"));
  const auto check = [&](const std::string& good, std::uint64_t seed, auto parse, int least = 500) {
    CAPTURE(seed);
    CHECK(count_refused_mutants(good, seed, 4000, [&](const std::string& bad) {
            MeshNotes notes;
            return triangulate("a", parse("a", bad, notes), notes);
          }) > least);
  };
  check(format_off(mesh), 1, parse_off);
  check(format_obj(mesh), 2, parse_obj);
  check(format_stl(mesh), 3, parse_stl);
  check(format_ply(mesh), 4, parse_ply);
  check(binary_ply(), 5, parse_ply);
}
