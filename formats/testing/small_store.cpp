#include "formats/testing/small_store.hpp"

#include <unistd.h>

#include "formats/layout.hpp"

namespace greenloop {

TemporaryFile::TemporaryFile(const std::string& name)
    : path(std::filesystem::temp_directory_path() / ("greenloop-" + std::to_string(getpid()) + "-" + name)) {}

TemporaryFile::~TemporaryFile() { std::filesystem::remove(path); }

GreenStoreContents small_contents(int columns) {
  GreenStoreContents contents;
  auto& surface = contents.surface;
  surface.positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  surface.base_triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
  surface.parents.assign(6, {-1, -1});
  surface.vertex_end = {6};
  for (int a = 0; a < 6; ++a) {
    for (int b = a + 1; b < 6; ++b) {
      if (surface.positions[a] == -surface.positions[b]) continue;
      surface.positions.push_back((surface.positions[a] + surface.positions[b]) / 2);
      surface.parents.push_back({a, b});
    }
  }
  surface.vertex_end.push_back(surface.positions.size());
  const int count = static_cast<int>(surface.positions.size());
  contents.area = std::vector<double>(count, 0.1);
  for (int v = 0; v < count; ++v) contents.area[v] += 0.006 * v;
  contents.flags.assign(count, layout::node_domain | layout::node_read);
  for (int v = 1; v < count; ++v) contents.row_node.push_back(v);
  for (int v = 0; v < columns; ++v) contents.column_node.push_back(v);
  contents.volume.vertices = surface.positions;
  contents.volume.vertices.emplace_back(0, 0, 0);
  contents.volume.tetrahedra = {{0, 1, 4, 18}, {1, 2, 4, 18}};
  contents.volume_fixed.assign(contents.volume.vertices.size(), 0);
  contents.interpolation.resize(count, count + 1);
  for (int v = 0; v < count; ++v) contents.interpolation.insert(v, v) = 1.0 - 0.01 * v;
  contents.young = 2.5e4;
  contents.poisson = 0.45;
  contents.provenance = R"({"scene": "test"})";
  contents.fingerprint = "9f3c";
  return contents;
}

GreenStoreContents scalar_contents(int columns) {
  GreenStoreContents contents = small_contents(columns);
  contents.components = 1;
  contents.unit = "K/W";
  contents.young = contents.poisson = 0;
  return contents;
}

Eigen::MatrixXd column_values(int column, int rows, int components) {
  Eigen::MatrixXd values(components * rows, components);
  for (int c = 0; c < components; ++c) {
    for (int r = 0; r < components * rows; ++r) values(r, c) = column + 0.1 * c + 1e-4 * r;
  }
  return values;
}

}  // namespace greenloop
