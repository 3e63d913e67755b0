// Volumes as other programs write them: each file here is the same two tetrahedra.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

#include "formats/mesh/test_files.hpp"
#include "formats/mesh/volume_formats.hpp"
#include "formats/mesh/volume_io.hpp"
#include "formats/mesh/vtk_xml_array.hpp"

using namespace greenloop;

namespace {

const auto folder = scratch_folder("volume_dialects_test");

const TetrahedralMesh two{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}};

TetrahedralMesh read(const std::string& name, const std::string& content) {
  write_file(folder / name, content);
  return read_volume(folder / name);
}

void check_two(const TetrahedralMesh& mesh) {
  CHECK(mesh.vertices == two.vertices);
  CHECK(mesh.tetrahedra == two.tetrahedra);
}

template <typename T>
std::string bytes_of(const std::vector<T>& values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const T value : values) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

std::vector<double> coordinates() {
  std::vector<double> result;
  for (const auto& v : two.vertices) result.insert(result.end(), {v.x(), v.y(), v.z()});
  return result;
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j <= bytes.size() ? digits[group >> (18 - 6 * j) & 63] : '=';
    }
  }
  return text;
}

std::string deflated(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  auto size = static_cast<uLongf>(packed.size());
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) == Z_OK);
  packed.resize(size);
  return packed;
}

/// How a test file writes its arrays.
struct Style {
  bool compressed = false, long_lengths = false, big = false;
  std::string format = "binary";    ///< or "appended"
  std::string appended = "base64";  ///< or "raw"
};

std::string lengths(const Style& style, const std::vector<std::uint64_t>& values) {
  const auto order = style.big ? std::endian::big : std::endian::little;
  return style.long_lengths ? bytes_of(values, order)
                            : bytes_of(std::vector<std::uint32_t>(values.begin(), values.end()), order);
}

/// An array with its lengths, as the format wants it; compressed in blocks of 32 bytes.
std::string packed(const Style& style, const std::string& bytes) {
  const bool as_text = style.format == "binary" || style.appended == "base64";
  const auto written = [&](const std::string& piece) { return as_text ? base64(piece) : piece; };
  if (!style.compressed) return written(lengths(style, {bytes.size()}) + bytes);
  constexpr std::size_t block = 32;
  std::vector<std::uint64_t> head{(bytes.size() + block - 1) / block, block, bytes.size() % block};
  std::string blocks;
  for (std::size_t at = 0; at < bytes.size(); at += block) {
    const auto one = deflated(bytes.substr(at, block));
    head.push_back(one.size());
    blocks += one;
  }
  return written(lengths(style, head)) + written(blocks);
}

std::string vtu(const Style& style) {
  const auto order = style.big ? std::endian::big : std::endian::little;
  std::string appended;
  const auto array = [&](const std::string& type, const std::string& name, const std::string& more,
                         const std::string& bytes) {
    const auto data = packed(style, bytes);
    const auto offset = std::to_string(appended.size());
    const bool here = style.format == "binary";
    appended += here ? "" : data;
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\"" + more + " format=\"" + style.format + "\"" +
           (here ? ">\n" + data + "\n</DataArray>\n" : " offset=\"" + offset + "\"/>\n");
  };
  std::string text = std::string("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"") +
                     (style.big ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
                     (style.long_lengths ? "UInt64" : "UInt32") + "\"" +
                     (style.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") +
                     "><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Points>\n";
  text +=
      array("Float64", "Points", " NumberOfComponents=\"3\"", bytes_of(coordinates(), order)) + "</Points>\n<Cells>\n";
  text += array("UInt8", "types", "", bytes_of(std::vector<std::uint8_t>{10, 10}));
  text += array("Int64", "connectivity", "", bytes_of(std::vector<std::int64_t>{0, 1, 2, 3, 1, 2, 3, 4}, order));
  text += array("Int32", "offsets", "", bytes_of(std::vector<std::int32_t>{4, 8}, order));
  text += "</Cells>\n</Piece></UnstructuredGrid>\n";
  if (!appended.empty())
    text += "<AppendedData encoding=\"" + style.appended + "\">\n_" + appended + "\n</AppendedData>\n";
  return text + "</VTKFile>\n";
}

std::vector<Style> all_styles() {
  std::vector<Style> styles;
  for (const int bits : {0, 1, 2, 3, 4, 5, 6, 7}) {
    const Style style{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
    styles.push_back(style);
    styles.push_back({style.compressed, style.long_lengths, style.big, "appended", "base64"});
    styles.push_back({style.compressed, style.long_lengths, style.big, "appended", "raw"});
  }
  return styles;
}

std::string vtk(bool version_5) {
  const auto big = std::endian::big;
  std::string bytes = "# vtk DataFile Version 3.0\ntwo\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n" +
                      bytes_of(coordinates(), big);
  if (version_5) {
    bytes += "\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n" +
             bytes_of(std::vector<std::int64_t>{0, 4, 8}, big) + "\nCONNECTIVITY vtktypeint64\n" +
             bytes_of(std::vector<std::int64_t>{0, 1, 2, 3, 1, 2, 3, 4}, big);
  } else {
    bytes += "\nCELLS 2 10\n" + bytes_of(std::vector<std::int32_t>{4, 0, 1, 2, 3, 4, 1, 2, 3, 4}, big);
  }
  return bytes + "\nCELL_TYPES 2\n" + bytes_of(std::vector<std::int32_t>{10, 10}, big) + "\nPOINT_DATA 5\n";
}

/// Numbered 10, 20, ...; a triangle too.
std::string gmsh_2(std::endian order) {
  std::string bytes = "$MeshFormat\n2.2 1 8\n" + bytes_of<std::int32_t>({1}, order) + "\n$EndMeshFormat\n$Nodes\n5\n";
  for (std::int32_t i = 0; i < 5; ++i) {
    const auto& v = two.vertices[static_cast<std::size_t>(i)];
    bytes += bytes_of<std::int32_t>({10 * (i + 1)}, order) + bytes_of<double>({v.x(), v.y(), v.z()}, order);
  }
  bytes += "\n$EndNodes\n$Elements\n3\n" + bytes_of<std::int32_t>({2, 1, 2, 1, 0, 1, 10, 20, 30}, order);
  return bytes + bytes_of<std::int32_t>({4, 2, 2, 2, 0, 1, 10, 20, 30, 40, 3, 0, 1, 20, 30, 40, 50}, order) +
         "\n$EndElements\n";
}

std::string gmsh_4(std::endian order) {
  using Longs = std::vector<std::int64_t>;
  std::string bytes = "$MeshFormat\n4.1 1 8\n" + bytes_of<std::int32_t>({1}, order) + "\n$EndMeshFormat\n$Entities\n" +
                      bytes_of(Longs{0, 0, 0, 0}, order) + "\n$EndEntities\n$Nodes\n";
  bytes += bytes_of(Longs{2, 5, 10, 50}, order) + bytes_of<std::int32_t>({2, 1, 1}, order) +
           bytes_of(Longs{1, 10}, order) + bytes_of<double>({0, 0, 0, 0.5, 0.5}, order);
  bytes += bytes_of<std::int32_t>({3, 1, 0}, order) + bytes_of(Longs{4, 20, 30, 40, 50}, order);
  const auto all = coordinates();
  bytes += bytes_of(std::vector<double>(all.begin() + 3, all.end()), order) + "\n$EndNodes\n$Elements\n";
  bytes += bytes_of(Longs{2, 3, 1, 3}, order) + bytes_of<std::int32_t>({2, 1, 2}, order) +
           bytes_of(Longs{1, 1, 10, 20, 30}, order);
  return bytes + bytes_of<std::int32_t>({3, 1, 4}, order) +
         bytes_of(Longs{2, 2, 10, 20, 30, 40, 3, 20, 30, 40, 50}, order) + "\n$EndElements\n";
}

/// The two tetrahedra, a section that nobody knows, and the end.
std::string meshb(int version, std::endian order) {
  const auto word = [&](std::int64_t value) {
    return bytes_of<std::int32_t>({static_cast<std::int32_t>(value)}, order);
  };
  const auto either = [&](std::int64_t value, bool wide) {
    return wide ? bytes_of<std::int64_t>({value}, order) : word(value);
  };
  std::string bytes = word(1) + word(version);
  const auto section = [&](int keyword, const std::string& content) {
    const auto next = bytes.size() + 4 + (version < 3 ? 4 : 8) + content.size();
    bytes += word(keyword) + either(static_cast<std::int64_t>(next), version >= 3) + content;
  };
  const bool wide = version >= 4;
  std::string points = either(5, wide), cells = either(2, wide);
  for (const auto& v : two.vertices) {
    points +=
        version < 2
            ? bytes_of<float>({static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}, order)
            : bytes_of<double>({v.x(), v.y(), v.z()}, order);
    points += either(7, wide);
  }
  for (const auto& t : two.tetrahedra) {
    for (const int node : t) cells += either(node + 1, wide);
    cells += either(7, wide);
  }
  section(3, word(3));
  section(8, cells);
  section(81, "anything");
  section(10, either(0, wide));
  section(4, points);
  return bytes + word(54) + either(0, version >= 3);
}

}  // namespace

TEST_CASE("Medit, binary: versions 1 to 4, both byte orders, either extension, sections in any order") {
  for (const int version : {1, 2, 3, 4}) {
    for (const auto order : {std::endian::little, std::endian::big}) {
      CAPTURE(version);
      check_two(read("a.meshb", meshb(version, order)));
    }
  }
  check_two(read("a.mesh", meshb(2, std::endian::little)));
}

TEST_CASE("Medit, binary, refused: what is no place, no count, no vertex, no tetrahedra") {
  const auto little = std::endian::little;
  const auto right = meshb(2, little);
  const auto changed = [&](std::size_t at, std::int32_t value) {
    auto bytes = right;
    return bytes.replace(at, 4, bytes_of<std::int32_t>({value}, little));
  };
  const auto refuse = [&](const std::string& bytes, const std::string& why) {
    check_refused([&] { return read("a.meshb", bytes); }, why);
  };
  refuse(changed(4, 5), "found version 5");
  refuse(changed(8, 4), "found keyword 4");
  refuse(changed(12, 7), "found the next section at byte 7");
  refuse(changed(12, 1 << 30), "found the next section at byte 1073741824");
  refuse(changed(16, 2), "found dimension 2");
  refuse(changed(20, 9), "found prisms");
  refuse(changed(24, 20), "found the next section at byte 20");
  refuse(changed(28, -1), "found -1 tetrahedra");
  refuse(changed(28, 3), "found 3 tetrahedra at byte 32, expected as many as fit the 40 bytes of the section");
  refuse(changed(32, 0), "found vertex 0");
  refuse(changed(32, 6), "found vertex 6");
  refuse(right.substr(0, right.size() - 40), "found the next section at byte 252");
  refuse(right.substr(0, 10), "found the end");
}

TEST_CASE("VTK XML: inline and appended, base64 and raw, compressed or not, lengths and bytes of either kind") {
  for (const auto& style : all_styles()) {
    CAPTURE(style.compressed);
    CAPTURE(style.long_lengths);
    CAPTURE(style.big);
    CAPTURE(style.format + " " + style.appended);
    check_two(read("a.vtu", vtu(style)));
  }
  write_file(folder / "A.VTU", vtu({}));
  check_two(read_volume(folder / "A.VTU"));
}

TEST_CASE("VTK XML refused: damaged blocks, lengths beyond the bytes, other compressors, arrays twice") {
  const auto good = vtu({true, false, false, "appended", "raw"});
  auto bad = good;
  bad[good.find("\n_") + 40] ^= 1;
  check_refused([&] { return read("a.vtu", bad); }, "expected a whole array");
  check_refused([&] { return read("a.vtu", good.substr(0, good.size() - 60)); },
                "are promised, expected a whole array");
  bad = good;
  bad.replace(bad.find("vtkZLib"), 7, "vtkLZ4D");
  check_refused([&] { return read("a.vtu", bad); }, "expected vtkZLibDataCompressor as the only compressor");
  bad = good;
  bad.replace(bad.find("\"types\""), 7, "\"offsets\"");
  check_refused([&] { return read("a.vtu", bad); }, "expected this array once");
}

TEST_CASE("compressed arrays promise no more than zlib can hold") {
  const VtkEncoding encoding{.compressed = true};
  const auto bomb = bytes_of<std::uint32_t>({1, 1U << 30, 0, 4}) + "abcd";
  check_refused([&] { return unpack_array(bomb, encoding, "a"); }, "a: found 1073741824 bytes packed into 4, expected");
  const auto many = bytes_of<std::uint32_t>({0xffffffff, 1U << 30, 0, 4}) + "abcd";
  check_refused([&] { return unpack_array(many, encoding, "a"); }, "a: found 4294967295 blocks");
  const std::string zeros(1 << 20, '\0');
  const auto small = deflated(zeros);
  CHECK(unpack_array(bytes_of<std::uint32_t>({1, 1U << 20, 0, static_cast<std::uint32_t>(small.size())}) + small,
                     encoding, "a") == zeros);
}

TEST_CASE("VTK legacy, binary: versions 3 and 5") {
  check_two(read("a.vtk", vtk(false)));
  check_two(read("a.vtk", vtk(true)));
  check_refused([] { return read("a.vtk", vtk(true).substr(0, 320)); }, "bytes of numbers");
}

TEST_CASE("Gmsh, binary: 2.2 and 4.1, both byte orders") {
  for (const auto order : {std::endian::little, std::endian::big}) {
    check_two(read("a.msh", gmsh_2(order)));
    check_two(read("a.msh", gmsh_4(order)));
  }
  check_refused([] { return read("a.msh", gmsh_2(std::endian::little).substr(0, 150)); }, "a.msh:");
}

TEST_CASE("Gmsh: nodes numbered down, up and in between, one twice") {
  const auto file = [](const std::string& numbers) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n" + numbers +
           "$EndNodes\n$Elements\n2\n1 4 0 50 -7 3 20\n" + "2 4 0 -7 3 20 8\n$EndElements\n";
  };
  check_two(read("a.msh", file("50 0 0 0\n-7 1 0 0\n3 0 1 0\n20 0 0 1\n8 1 1 1\n")));
  check_refused([&] { return read("a.msh", file("3 0 0 0\n50 1 0 0\n-7 0 1 0\n20 0 0 1\n50 1 1 1\n")); },
                "a.msh:10: found \"node 50 again\"");
  check_refused([&] { return read("a.msh", file("3 0 0 0\n50 1 0 0\n-7 0 1 0\n20 0 0 1\n-7 1 1 1\n")); },
                "a.msh:10: found \"node -7 again\"");
}

TEST_CASE("many nodes whose numbers a table of remainders could not tell apart are read as fast as any") {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n100000\n";
  for (std::int64_t i = 1; i <= 100000; ++i) {
    text += std::to_string(i * 107897) + (i == 2 ? " 1 0 0\n" : i == 3 ? " 0 1 0\n" : i == 4 ? " 0 0 1\n" : " 0 0 0\n");
  }
  text += "$EndNodes\n$Elements\n1\n1 4 0 107897 215794 323691 431588\n$EndElements\n";
  write_file(folder / "a.msh", text);
  const std::clock_t begin = std::clock();
  CHECK(read_volume(folder / "a.msh").vertices.size() == 4);
  CHECK(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < 3);
}

TEST_CASE("Medit and Gmsh: line ends, byte order mark, words in lower case") {
  for (const auto* const name : {"a.mesh", "a.msh"}) {
    write_volume(folder / name, two);
    auto text = read_file(folder / name);
    check_two(read(name, "\xef\xbb\xbf" + text));
    std::replace(text.begin(), text.end(), '\n', '\r');
    check_two(read(name, text));
  }
  write_volume(folder / "a.mesh", two);
  auto text = read_file(folder / "a.mesh");
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  check_two(read("a.mesh", text));
}

TEST_CASE("TetGen: markers, attributes, numbers from 0 or 1, extensions in upper case, both files in the mesh") {
  for (const int first : {0, 1}) {
    for (const auto* const more : {"", " 7", " 0.5 -1"}) {
      std::string nodes = "# made by hand\n5 3 0 1\n", elements = "2 4 1\n";
      for (int i = 0; i < 5; ++i) {
        nodes += std::to_string(i + first) + " ";
        append_point(nodes, two.vertices[static_cast<std::size_t>(i)]);
        nodes += more + std::string("\n");
      }
      for (const auto& [a, b, c, d] : two.tetrahedra) {
        elements += std::to_string(first);
        for (const int node : {a, b, c, d}) elements.append(" ").append(std::to_string(node + first));
        elements += more + std::string("\n");
      }
      write_file(folder / "t.1.node", nodes);
      write_file(folder / "t.1.ele", elements);
      write_file(folder / "U.NODE", nodes);
      write_file(folder / "U.ELE", elements);
      for (const auto* const name : {"t.1.node", "t.1.ele", "U.NODE", "U.ELE"}) {
        CAPTURE(name);
        check_two(read_volume(folder / name));
      }
    }
  }
  CHECK(files_of_mesh("m/t.node") == std::vector<std::filesystem::path>{"m/t.node", "m/t.ele"});
  CHECK(files_of_mesh("m/T.ELE") == std::vector<std::filesystem::path>{"m/T.ELE", "m/T.NODE"});
  CHECK(files_of_mesh("m/t.msh") == std::vector<std::filesystem::path>{"m/t.msh"});
}

TEST_CASE("damaged files are read or refused, never worse; seeds 1 to 9") {
  const auto check = [&](const std::string& good, std::uint64_t seed, auto parse) {
    CAPTURE(seed);
    CHECK(count_refused_mutants(good, seed, 4000, [&](const std::string& bad) {
            MeshNotes notes;
            return parse("a", bad, notes);
          }) > 500);
  };
  check(vtu({}), 1, parse_vtu);
  check(vtu({true, true, false}), 2, parse_vtu);
  check(vtu({true, false, true, "appended", "raw"}), 3, parse_vtu);
  check(vtu({true, false, false, "appended", "base64"}), 4, parse_vtu);
  check(vtk(false), 5, parse_vtk);
  check(vtk(true), 6, parse_vtk);
  check(gmsh_2(std::endian::little), 7, parse_gmsh);
  check(gmsh_4(std::endian::big), 8, parse_gmsh);
  check(meshb(2, std::endian::little), 9, parse_medit);
}
