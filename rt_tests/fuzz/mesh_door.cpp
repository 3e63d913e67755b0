#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <string>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/volume_formats.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "rt_tests/fuzz/doors.hpp"

namespace greenloop {
namespace {

using SurfaceReader = PolygonMesh (*)(const std::filesystem::path&, std::string, MeshNotes&);
using VolumeReader = VolumeBuilder (*)(const std::filesystem::path&, std::string, MeshNotes&);

// a right file, and who reads it
struct Seed {
  SurfaceReader surface = nullptr;
  VolumeReader volume = nullptr;
  std::string name, content;
};

template <class T>
std::string bytes_of(std::initializer_list<T> values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const T value : values) {
    const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    order == std::endian::native ? bytes.append(raw.begin(), raw.end()) : bytes.append(raw.rbegin(), raw.rend());
  }
  return bytes;
}

std::string ply(const std::string& format, const std::string& values) {
  return "ply\nformat " + format +
         " 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property list uchar int w\nelement face 2\nproperty list uchar int vertex_indices\nelement tristrips 1\n"
         "property list int int vertex_indices\nend_header\n" +
         values;
}

std::string binary_ply(std::endian order) {
  std::string bytes;
  for (const auto& [x, y, z] : {std::array{0.F, 0.F, 0.F}, {1.F, 0.F, 0.F}, {0.F, 1.F, 0.F}, {0.F, 0.F, 1.F}}) {
    bytes += bytes_of({x, y, z}, order) + '\1' + bytes_of({7}, order);
  }
  bytes += '\3' + bytes_of({0, 2, 1}, order) + '\4' + bytes_of({0, 1, 3, 2}, order) + bytes_of({4, 0, 1, 2, -1}, order);
  return ply(order == std::endian::big ? "binary_big_endian" : "binary_little_endian", bytes);
}

std::string binary_stl() {
  std::string bytes = std::string(80, ' ') + bytes_of({2});
  for (int facet = 0; facet < 2; ++facet) {
    bytes += std::string(12, '\0') + bytes_of({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) + std::string(2, '\0');
  }
  return bytes;
}

std::string binary_gmsh_2(std::endian order) {
  std::string bytes = "$MeshFormat\n2.2 1 8\n" + bytes_of({1}, order) + "\n$EndMeshFormat\n$Nodes\n4\n";
  int number = 0;
  for (const auto& [x, y, z] : {std::array{0., 0., 0.}, {1., 0., 0.}, {0., 1., 0.}, {0., 0., 1.}}) {
    bytes += bytes_of({++number}, order) + bytes_of({x, y, z}, order);
  }
  return bytes + "\n$EndNodes\n$Elements\n2\n" + bytes_of({2, 1, 2, 1, 0, 1, 1, 2, 3}, order) +
         bytes_of({4, 1, 2, 2, 0, 1, 1, 2, 3, 4}, order) + "\n$EndElements\n";
}

std::string binary_gmsh_4(std::endian order) {
  using Long = std::int64_t;
  return "$MeshFormat\n4.1 1 8\n" + bytes_of({1}, order) + "\n$EndMeshFormat\n$Nodes\n" +
         bytes_of<Long>({1, 4, 1, 4}, order) + bytes_of({3, 1, 0}, order) + bytes_of<Long>({4, 1, 2, 3, 4}, order) +
         bytes_of({0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.}, order) + "\n$EndNodes\n$Elements\n" +
         bytes_of<Long>({1, 1, 1, 1}, order) + bytes_of({3, 1, 4}, order) + bytes_of<Long>({1, 1, 1, 2, 3, 4}, order) +
         "\n$EndElements\n";
}

// version 2: places and numbers of four bytes, doubles
std::string binary_medit(std::endian order) {
  return bytes_of({1, 2, 3, 20, 3}, order) + bytes_of({4, 160, 4}, order) + bytes_of({0., 0., 0.}, order) +
         bytes_of({0}, order) + bytes_of({1., 0., 0.}, order) + bytes_of({0}, order) + bytes_of({0., 1., 0.}, order) +
         bytes_of({0}, order) + bytes_of({0., 0., 1.}, order) + bytes_of({0}, order) + std::string(16, '\0') +
         bytes_of({8, 192, 1, 1, 2, 3, 4, 0}, order) + bytes_of({54, 0}, order);
}

std::string vtk(const std::string& rest) { return "# vtk DataFile Version 5.1\nx\n" + rest; }

std::string vtu(const std::string& more, const std::string& points, const std::string& types,
                const std::string& connectivity, const std::string& offsets, const std::string& rest) {
  const auto array = [](const std::string& type, const std::string& name, const std::string& content) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           (name == "Points" ? "3" : "1") + "\" " + content + "\n";
  };
  return "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt32\"" +
         more + "><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>" +
         array("Float64", "Points", points) + "</Points><Cells>" + array("UInt8", "types", types) +
         array("Int64", "connectivity", connectivity) + array("Int32", "offsets", offsets) +
         "</Cells></Piece></UnstructuredGrid>" + rest + "</VTKFile>\n";
}

std::string here(const std::string& format, const std::string& values) {
  return "format=\"" + format + "\">" + values + "</DataArray>";
}

std::string appended(int offset) { return "format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>"; }

std::string text_vtu() {
  return vtu("", here("ascii", "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"), here("ascii", "10 10"),
             here("ascii", "0 1 2 3 1 2 3 4"), here("ascii", "4 8"), "");
}

std::string compressed_vtu() {
  return vtu(" compressor=\"vtkZLibDataCompressor\"",
             here("binary", "AQAAAHgAAAAAAAAAFAAAAA==eJxjYMAHPtjjlSZaHpMGAPByBxs="),
             here("binary", "AQAAAAIAAAAAAAAACgAAAA==eJzj4gIAACAAFQ=="),
             here("binary", "AQAAAEAAAAAAAAAAFgAAAA==eJxjYIAARijNBKWZCYizQGkAAfAAEQ=="),
             here("binary", "AQAAAAgAAAAAAAAADgAAAA==eJxjYWBg4ABiAABIAA0="), "");
}

std::string appended_vtu() {
  using Long = std::int64_t;
  const std::string raw = bytes_of({120}) + bytes_of({0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 1., 1., 1.}) +
                          bytes_of({2}) + "\n\n" + bytes_of({64}) + bytes_of<Long>({0, 1, 2, 3, 1, 2, 3, 4}) +
                          bytes_of({8}) + bytes_of({4, 8});
  return vtu("", appended(0), appended(124), appended(130), appended(198),
             "<AppendedData encoding=\"raw\">\n_" + raw + "</AppendedData>");
}

class MeshDoor final : public Door {
 public:
  MeshDoor() {
    const auto ele = folder_.write("m.ele", "1 4 0\n1 1 2 3 4\n");
    const std::string nodes = "# x\n4 3 1 1\n1 0 0 0 9 1\n2 1 0 0 9 1\n3 0 1 0 9 1\n4 0 0 1 9 1\n";
    const std::string corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n", sides = "0 1 4\n", concave = "1 2 3 4";
    surface(parse_off, "m.off", "OFF\n5 2 0\n" + corners + "4 0 1 2 3\n3 0 1 4 255 0 0\n");
    surface(parse_off, "m.off", "COFF\n# x\n3 1 3\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
    surface(parse_obj, "m.obj", "v 0 0 0 1 1 1\nv 1 0 0\nv 0.2 0.2 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 \\\n3 -1//2\ng x\n");
    surface(parse_stl, "m.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
            "endsolid a\nsolid b\nend solid b\n");
    surface(parse_stl, "m.stl", binary_stl());
    surface(parse_ply, "m.ply",
            ply("ascii", "0 0 0 1 7\n1 0 0 0\n0 1 0 2 7 nan\n0 0 1 0\n3 0 2 1\n4 0 1 3 2\n4 0 1 2 -1\n"));
    surface(parse_ply, "m.ply", binary_ply(std::endian::little));
    surface(parse_ply, "m.ply", binary_ply(std::endian::big));
    surface(parse_vtk_surface, "m.vtk",
            vtk("ASCII\nDATASET POLYDATA\nPOINTS 5 float\n" + corners +
                "POLYGONS 3 7\nOFFSETS vtktypeint64\n0 4 7\n"
                "CONNECTIVITY vtktypeint64\n0 1 2 3 0 1 4\nTRIANGLE_STRIPS 1 5\n4 0 1 2 4\nPOINT_DATA 5\n"));
    volume(parse_gmsh, "m.msh",
           "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n$EndNodes\n"
           "$Elements\n2\n1 2 2 0 1 10 20 30\n2 4 2 0 1 10 20 30 40\n$EndElements\n");
    volume(parse_gmsh, "m.msh",
           "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 4 10 40\n2 1 1 3\n10\n20\n30\n0 0 0 0.5 0.5\n1 0 0 0 0\n"
           "0 1 0 0 0\n3 1 0 1\n40\n0 0 1\n$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 10 20 30\n3 1 4 1\n2 10 20 30 40\n"
           "$EndElements\n");
    for (const auto order : {std::endian::little, std::endian::big}) {
      volume(parse_gmsh, "m.msh", binary_gmsh_2(order));
      volume(parse_gmsh, "m.msh", binary_gmsh_4(order));
      volume(parse_medit, "m.meshb", binary_medit(order));
    }
    volume(parse_medit, "m.mesh",
           "MeshVersionFormatted 1\n# x\nDimension\n3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\nTriangles\n1\n"
           "1 2 3 7\nTetrahedra\n1\n1 2 3 4 7\nEnd\n");
    volume(parse_vtk, "m.vtk",
           vtk("ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n" + corners +
               "METADATA\nINFORMATION 0\n\n"
               "CELLS 3 7\nOFFSETS vtktypeint64\n0 3 7\nCONNECTIVITY vtktypeint64\n0 1 2\n0 1 2 4\nCELL_TYPES "
               "2\n5\n10\n"));
    for (const std::string& content : {text_vtu(), compressed_vtu(), appended_vtu()})
      volume(parse_vtu, "m.vtu", content);
    volume(parse_vega, "m.veg",
           "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n*MATERIAL B\n"
           "ENU, 1000, 1e7, 0.45\n*REGION\nallElements, B\n");
    volume(parse_tetgen, (ele.parent_path() / "m.node").string(), nodes);
  }

  bool try_one(Random& random) override {
    const Seed& seed = one_of(random, seeds_);
    std::string content = seed.content;
    if (below(random, 3) == 0) {
      mutate(random, content);
    } else {
      mutate_text(random, content);
    }
    try {
      MeshNotes notes;
      if (seed.surface != nullptr) {
        (void)triangulate(seed.name, seed.surface(seed.name, std::move(content), notes), notes);
      } else {
        auto cells = seed.volume(seed.name, std::move(content), notes);
        (void)VolumeBuilder(cells).skin(notes);
        (void)cells.finish();
      }
      return true;
    } catch (const MeshFileError&) {
      return false;
    }
  }

 private:
  static void mutate(Random& random, std::string& content) {
    const auto* const data = reinterpret_cast<const std::byte*>(content.data());
    Bytes bytes(data, data + content.size());
    mutate_bytes(random, 256, bytes);
    content.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  void surface(SurfaceReader reader, const std::string& name, const std::string& content) {
    try_right({reader, nullptr, name, content});
  }
  void volume(VolumeReader reader, const std::string& name, const std::string& content) {
    try_right({nullptr, reader, name, content});
  }
  // a file that is refused before it is changed tries little
  void try_right(Seed seed) {
    MeshNotes notes;
    if (seed.surface != nullptr) {
      (void)triangulate(seed.name, seed.surface(seed.name, seed.content, notes), notes);
    } else {
      (void)seed.volume(seed.name, seed.content, notes).finish();
    }
    seeds_.push_back(std::move(seed));
  }

  TemporaryFolder folder_{"mesh_door"};
  std::vector<Seed> seeds_;
};

}  // namespace

std::unique_ptr<Door> mesh_door() { return std::make_unique<MeshDoor>(); }

}  // namespace greenloop
