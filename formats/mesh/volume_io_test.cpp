#include "formats/mesh/volume_io.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "formats/mesh/test_files.hpp"
#include "formats/mesh/volume_formats.hpp"

using namespace greenloop;
using Eigen::Vector3d;

namespace {

const auto folder = scratch_folder("volume_io_test");

/// Two tetrahedra on a common face, positively oriented.
TetrahedralMesh two() {
  return {{{0, 0, 0}, {1.0 / 3, 0, 0}, {0, 0.1, 0}, {0, 0, 1e-7}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}};
}

void check_same(const TetrahedralMesh& a, const TetrahedralMesh& b) {
  CHECK(a.vertices == b.vertices);
  CHECK(a.tetrahedra == b.tetrahedra);
}

TetrahedralMesh read_text(const std::string& name, std::string_view text) {
  write_file(folder / name, text);
  return read_volume(folder / name);
}

void refuse(const std::string& name, std::string_view text, std::string_view piece) {
  check_refused([&] { return read_text(name, text); }, piece);
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// The unit tetrahedron and what the readers make of it.
const TetrahedralMesh unit{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};

// Node numbers with gaps, a node in no tetrahedron, a triangle.
const std::string gmsh_2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n$Nodes\n5\n10 0 0 0\n"
    "20 1 0 0\n7 5 5 5\n30 0 1 0\n40 0 0 1\n$EndNodes\n$Elements\n2\n1 2 2 0 1 10 20 30\n2 4 2 0 1 10 20 30 40\n"
    "$EndElements\n";

const std::string gmsh_4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n2 4 10 40\n"
    "2 1 1 3\n10\n20\n30\n0 0 0 0.5 0.5\n1 0 0 0 0\n0 1 0 0 0\n3 1 0 1\n40\n0 0 1\n$EndNodes\n$Elements\n2 2 1 2\n"
    "2 1 2 1\n1 10 20 30\n3 1 4 1\n2 10 20 30 40\n$EndElements\n";

const std::string medit =
    "MeshVersionFormatted 1\n# comment\nDimension\n3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nTriangles\n1\n"
    "1 2 3 7\nHexahedra\n0\nTetrahedra\n1\n1 2 3 4 7\nEnd\n";

const std::string vtk_3 =
    "# vtk DataFile Version 3.0\nany title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0\n0 1 0 0 0 "
    "1\n"
    "CELLS 2 9\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 2\n5\n10\nPOINT_DATA 4\nSCALARS a float\n";

const std::string vtk_5 =
    "# vtk DataFile Version 5.1\nany title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0\n0 0 "
    "1\n"
    "METADATA\nINFORMATION 0\n\nCELLS 3 7\nOFFSETS vtktypeint64\n0 3 7\nCONNECTIVITY vtktypeint64\n0 1 2\n0 1 2 3\n"
    "CELL_TYPES 2\n5\n10\n";

const std::string vtu =
    "<?xml version=\"1.0\"?>\n<!-- <Piece> -->\n<VTKFile type=\"UnstructuredGrid\" "
    "version=\"1.0\">\n<UnstructuredGrid>\n"
    "<Piece NumberOfPoints=\"4\" NumberOfCells='2'>\n<PointData><DataArray Name=\"a\" "
    "format=\"binary\">AAAA</DataArray>"
    "</PointData>\n<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 "
    "1 0 0 "
    "0 1 0 0 0 1</DataArray></Points>\n<Cells>\n<DataArray Name=\"connectivity\" format=\"ascii\">0 1 2 0 1 2 "
    "3</DataArray>\n"
    "<DataArray Name=\"offsets\" format=\"ascii\">\n3 7\n</DataArray>\n<DataArray Name=\"types\" format=\"ascii\">5 10"
    "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

const std::string tetgen_node = "# comment\n4 3 1 1\n1 0 0 0 9 1\n2 1 0 0 9 1\n3 0 1 0 9 1\n4 0 0 1 9 1\n";
const std::string tetgen_ele = "1 4 0\n1 1 2 3 4\n";

const std::string vega =
    "# Vega mesh file\n*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n\n"
    "*MATERIAL BODY\nENU, 1000, 10000000, 0.45\n*REGION\nallElements, BODY\n";

}  // namespace

TEST_CASE("what is written reads back bit by bit") {
  for (const auto* name : {"a.msh", "a.mesh", "a.vtk"}) {
    CAPTURE(name);
    write_volume(folder / name, two());
    check_same(read_volume(folder / name), two());
  }
}

TEST_CASE("Gmsh 2.2: gaps in numbers, faces and nodes without tetrahedron") {
  check_same(read_text("a.msh", gmsh_2), unit);
}

TEST_CASE("Gmsh 4.1: blocks, parametric nodes") { check_same(read_text("a.msh", gmsh_4), unit); }

TEST_CASE("Gmsh 1.0, Windows line ends") {
  check_same(read_text("a.msh",
                       "$NOD\r\n4\r\n1 0 0 0\r\n2 1 0 0\r\n3 0 1 0\r\n4 0 0 1\r\n$ENDNOD\r\n$ELM\r\n2\r\n1 2 1 1 3 1 2 "
                       "3\r\n2 4 1 1 4 1 2 3 4\r\n$ENDELM\r\n"),
             unit);
}

TEST_CASE("Medit: other sections, references") { check_same(read_text("a.mesh", medit), unit); }

TEST_CASE("VTK legacy: versions 3 and 5") {
  check_same(read_text("a.vtk", vtk_3), unit);
  check_same(read_text("a.vtk", vtk_5), unit);
}

TEST_CASE("VTK XML: comments, other arrays, both kinds of quotes") { check_same(read_text("a.vtu", vtu), unit); }

TEST_CASE("TetGen: either file, numbers from 1 or 0, attributes and markers") {
  write_file(folder / "t.node", tetgen_node);
  write_file(folder / "t.ele", tetgen_ele);
  check_same(read_volume(folder / "t.node"), unit);
  check_same(read_volume(folder / "t.ele"), unit);
  write_file(folder / "t.ele", "1 4 0\n0 0 1 2 3\n");
  write_file(folder / "t.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
  check_same(read_volume(folder / "t.ele"), unit);
}

TEST_CASE("Vega: materials are skipped") { check_same(read_text("a.veg", vega), unit); }

TEST_CASE("a mesh that is inverted as a whole is turned") {
  auto mesh = two();
  for (auto& t : mesh.tetrahedra) {
    std::swap(t[2], t[3]);
  }
  write_volume(folder / "a.msh", mesh);
  check_same(read_volume(folder / "a.msh"), two());
}

TEST_CASE("refused: an unknown extension, with the supported ones") {
  check_refused([] { return read_volume("a.off"); },
                "a.off: found extension \".off\", expected a file of tetrahedra: .msh, "
                ".mesh, .meshb, .vtk, .vtu, .node, .ele or .veg");
  check_refused([] { return write_volume("a.vtu", {}), 0; }, "expected a file of tetrahedra: .msh, .mesh or .vtk");
}

TEST_CASE("refused: some tetrahedra inverted") {
  auto mesh = two();
  std::swap(mesh.tetrahedra[1][2], mesh.tetrahedra[1][3]);
  write_volume(folder / "a.msh", mesh);
  check_refused([] { return read_volume(folder / "a.msh"); }, "a.msh:15: found tetrahedron 1 (counted from 0, centre ");
  check_refused([] { return read_volume(folder / "a.msh"); }, "inverted, 1 of 2 in all");
  check_refused([] { return read_volume(folder / "a.msh"); }, "name the file in [surface]");
}

TEST_CASE("refused: a flat tetrahedron") {
  refuse("a.msh", replaced(gmsh_2, "40 0 0 1", "40 1 1 0"),
         "a.msh:19: found tetrahedron 0 (counted from 0, centre 0.5 0.5 0) flat");
  refuse("a.msh", replaced(gmsh_2, "10 20 30 40", "10 20 30 30"), "flat, 1 in all");
}

TEST_CASE("refused: no tetrahedra") {
  refuse("a.msh", replaced(gmsh_2, "2\n1 2 2 0 1 10 20 30\n2 4 2 0 1 10 20 30 40", "1\n1 2 2 0 1 10 20 30"),
         "found no tetrahedron");
  refuse(
      "a.msh", replaced(gmsh_2, "2 4 2 0 1 10 20 30 40", "2 15 2 0 1 10"),
      "a.msh: found no tetrahedron, expected a volume mesh; its 1 faces may be a surface: name the file in [surface]");
  refuse("a.msh", "", "a.msh: found no tetrahedron");
}

TEST_CASE("refused: Gmsh") {
  refuse("a.msh", replaced(gmsh_2, "2.2 0 8", "4 0 8"),
         "a.msh:2: found \"version 4.000000\", expected version 2.2 or 4.1");
  refuse("a.msh", replaced(gmsh_2, "2.2 0 8", "2.2 1 8"), "expected the number 1 in binary");
  refuse("a.msh", replaced(gmsh_2, "$EndNodes", "$EndNode"), "a.msh:15: found \"$EndNode\", expected \"$EndNodes\"");
  refuse("a.msh", replaced(gmsh_2, "$EndPhysicalNames", "x"), "expected \"$EndPhysicalNames\"");
  refuse("a.msh", replaced(gmsh_2, "7 5 5 5", "10 5 5 5"),
         "a.msh:12: found \"node 10 again\", expected each node once");
  refuse("a.msh", replaced(gmsh_2, "7 5 5 5", "7 5 nan 5"), "a.msh:12: found \"nan\", expected the y coordinate");
  refuse("a.msh", replaced(gmsh_2, "10 20 30 40", "10 20 30 41"),
         "a.msh:19: found \"41\", expected the number of one of the 5 nodes");
  refuse("a.msh", replaced(gmsh_2, "2 4 2 0 1 10", "2 5 2 0 1 10"),
         "a.msh:19: found \"element type 5\", expected linear tetrahedra");
  refuse("a.msh", replaced(gmsh_2, "2 4 2 0 1 10", "2 11 2 0 1 10"), "a.msh:19: found \"element type 11\"");
  refuse("a.msh", replaced(gmsh_2, "\n5\n10", "\n500000000\n10"),
         "a.msh:9: found \"500000000\", expected the number of nodes that");
  refuse("a.msh", replaced(gmsh_2, "\n2\n1 2 2", "\n3\n1 2 2"), "found \"$EndElements\", expected a tag");
  refuse("a.msh", replaced(gmsh_4, "2 1 1 3\n10", "2 1 1 300000\n10"),
         "found \"300000\", expected the number of nodes of a block");
  refuse("a.msh", "hello\n", "a.msh:1: found \"hello\", expected a section such as $Nodes");
}

TEST_CASE("refused: Medit") {
  refuse("a.mesh", replaced(medit, "Dimension\n3", "Dimension\n2"), "a.mesh:4: found \"2\", expected dimension 3");
  refuse("a.mesh", replaced(medit, "1 2 3 4 7", "0 1 2 3 7"),
         "a.mesh:18: found \"0\", expected the number of one of the 4");
  refuse("a.mesh", replaced(medit, "Hexahedra\n0", "Hexahedra\n1"),
         "found \"Hexahedra\", expected linear tetrahedra only");
  refuse("a.mesh", replaced(medit, "Vertices\n4", "Vertices\n5"),
         "a.mesh:11: found \"Triangles\", expected the x coordinate");
  refuse("a.mesh",
         "\x7f"
         "ELF",
         "a.mesh:1: found \"?ELF\", expected \"MeshVersionFormatted\"");
}

TEST_CASE("refused: VTK legacy") {
  refuse("a.vtk", replaced(vtk_3, "ASCII", "TEXT"), "a.vtk:3: found \"TEXT\", expected \"ASCII\" or \"BINARY\"");
  refuse("a.vtk", replaced(vtk_3, "UNSTRUCTURED_GRID", "POLYDATA"),
         "found \"POLYDATA\", expected \"UNSTRUCTURED_GRID\"");
  refuse("a.vtk", replaced(vtk_3, "# vtk", "# abc"), "a.vtk:1: found \"# abc DataFile Version 3.0\"");
  refuse("a.vtk", replaced(vtk_3, "4 0 1 2 3", "4 0 1 2 4"),
         "a.vtk:10: found \"4\", expected a point index (a whole number, from 0 to 3)");
  refuse("a.vtk", replaced(vtk_3, "5\n10\n", "5\n12\n"),
         "a.vtk:13: found \"cell type 12\", expected linear tetrahedra");
  refuse("a.vtk", replaced(vtk_3, "5\n10\n", "10\n10\n"), "found \"tetrahedron of 3 points\", expected 4 points");
  refuse("a.vtk", replaced(vtk_3, "CELL_TYPES 2", "CELL_TYPES 1"), "expected 2 cells");
  refuse("a.vtk", replaced(vtk_5, "0 3 7", "0 5 3"), "found \"3\", expected the offset where a cell ends");
  refuse("a.vtk", replaced(vtk_5, "0 3 7", "0 3 999999999"), "expected 999999999 as the last offset says");
}

TEST_CASE("refused: VTK XML") {
  refuse("a.vtu", replaced(vtu, "type=\"UnstructuredGrid\"", "type=\"PolyData\""), "a.vtu:3: found \"VTKFile type=");
  refuse("a.vtu", replaced(vtu, "\"3\" format=\"ascii\"", "\"3\" format=\"packed\""), "expected format=\"ascii\"");
  refuse("a.vtu", replaced(vtu, "NumberOfComponents=\"3\"", "NumberOfComponents=\"2\""),
         "expected NumberOfComponents=\"3\"");
  refuse("a.vtu", replaced(vtu, "NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000\""), "expected NumberOfPoints=");
  refuse("a.vtu", replaced(vtu, "NumberOfPoints=\"4\"", "NumberOfPoints=\"5\""),
         "found \"</DataArray>\", expected the x coord");
  refuse("a.vtu", replaced(vtu, "</Piece>", "</Piece><Piece NumberOfPoints=\"4\">"), "expected a single Piece");
  refuse("a.vtu", replaced(vtu, "\"offsets\"", "\"sets\""),
         "expected arrays connectivity, offsets and types of 2 cells");
  refuse("a.vtu", replaced(vtu, "3 7", "3 6"),
         "found \"7 point indices of cells\", expected 6 as the last offset says");
  refuse("a.vtu", vtu.substr(0, vtu.find("?>")), "expected the end of this tag");
}

TEST_CASE("refused: TetGen") {
  std::filesystem::remove(folder / "u.ele");
  refuse("u.node", tetgen_node, "u.ele: no such file");
  write_file(folder / "u.ele", "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n");
  refuse("u.node", tetgen_node, "u.ele:1: found \"10\", expected 4 nodes per element");
  write_file(folder / "u.ele", "1 4 0\n1 1 2 3 5\n");
  refuse("u.node", tetgen_node, "u.ele:2: found \"5\", expected the number of one of the 4 nodes");
  refuse("u.node", "4 2 0 0\n1 0 0\n", "u.node:1: found");
}

TEST_CASE("refused: Vega") {
  refuse("a.veg", replaced(vega, "TET", "CUBIC"), "a.veg:10: found \"CUBIC\", expected \"TET\"");
  refuse("a.veg", replaced(vega, "*VERTICES", "*INCLUDE b.veg\n*VERTICES"),
         "found \"*INCLUDE\", expected all lists in one file");
}

TEST_CASE("damaged files are read or refused, never worse; seeds 1 to 7") {
  const auto check = [&](const std::string& good, std::uint64_t seed, auto parse) {
    CAPTURE(seed);
    CHECK(count_refused_mutants(good, seed, 4000, [&](const std::string& bad) {
            MeshNotes notes;
            return parse("a", bad, notes);
          }) > 500);
  };
  check(gmsh_2, 1, parse_gmsh);
  check(gmsh_4, 2, parse_gmsh);
  check(medit, 3, parse_medit);
  check(vtk_3, 4, parse_vtk);
  check(vtk_5, 5, parse_vtk);
  check(vtu, 6, parse_vtu);
  check(vega, 7, parse_vega);
}
