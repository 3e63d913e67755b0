#include "offline/volume/testing/shapes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <utility>

namespace greenloop::offline::testing {
namespace {

SemiRegularMesh icosahedron() {
  const double t = std::numbers::phi;
  SemiRegularMesh mesh;
  mesh.positions = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                    {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.base_triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                         {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                         {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (auto& x : mesh.positions) x.normalize();
  mesh.parents.assign(mesh.positions.size(), {-1, -1});
  mesh.vertex_end = {mesh.positions.size()};
  return mesh;
}

void split_on_unit_sphere(SemiRegularMesh& mesh) {
  std::map<std::pair<int, int>, bool> seen;
  for (const auto& t : triangles_of_level(mesh, mesh.finest_level())) {
    for (int k = 0; k < 3; ++k) {
      const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
      if (!seen.emplace(edge, true).second) continue;
      mesh.positions.push_back((mesh.positions[edge.first] + mesh.positions[edge.second]).normalized());
      mesh.parents.push_back({edge.first, edge.second});
    }
  }
  mesh.vertex_end.push_back(mesh.positions.size());
}

/// Three tetrahedra; neighbouring prisms cut their common side the same way because the smaller column starts it.
void cut_prism(std::array<int, 3> low, std::array<int, 3> high, TetrahedralMesh& mesh) {
  const auto first = std::min_element(low.begin(), low.end()) - low.begin();
  std::rotate(low.begin(), low.begin() + first, low.end());
  std::rotate(high.begin(), high.begin() + first, high.end());
  mesh.tetrahedra.push_back({low[0], high[0], high[1], high[2]});
  if (low[1] < low[2]) {
    mesh.tetrahedra.push_back({low[0], low[1], high[2], high[1]});
    mesh.tetrahedra.push_back({low[0], low[1], low[2], high[2]});
  } else {
    mesh.tetrahedra.push_back({low[0], low[2], high[2], high[1]});
    mesh.tetrahedra.push_back({low[0], low[1], low[2], high[1]});
  }
}

void orient(TetrahedralMesh& mesh) {
  for (auto& t : mesh.tetrahedra) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh.vertices[t[k + 1]] - mesh.vertices[t[0]];
    if (edges.determinant() < 0.0) std::swap(t[2], t[3]);
  }
}

}  // namespace

SemiRegularMesh ellipsoid(int levels, const Eigen::Vector3d& semi_axes) {
  auto mesh = icosahedron();
  for (int l = 0; l < levels; ++l) split_on_unit_sphere(mesh);
  for (auto& x : mesh.positions) x = x.cwiseProduct(semi_axes).eval();
  return mesh;
}

TriangleMesh torus(double radius, double tube_radius, int around, int across) {
  TriangleMesh mesh;
  const auto number = [&](int i, int j) { return (i % around) * across + j % across; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * j / across;
      const double distance = radius + tube_radius * std::cos(v);
      mesh.vertices.emplace_back(distance * std::cos(u), distance * std::sin(u), tube_radius * std::sin(v));
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  }
  return mesh;
}

TetrahedralMesh box(const Eigen::Vector3i& cells, const Eigen::Vector3d& size) {
  TetrahedralMesh mesh;
  const auto number = [&](const Eigen::Vector3i& p) {
    return (p.z() * (cells.y() + 1) + p.y()) * (cells.x() + 1) + p.x();
  };
  for (int k = 0; k <= cells.z(); ++k) {
    for (int j = 0; j <= cells.y(); ++j) {
      for (int i = 0; i <= cells.x(); ++i) {
        mesh.vertices.emplace_back(Eigen::Vector3d(i, j, k).cwiseProduct(size).cwiseQuotient(cells.cast<double>()));
      }
    }
  }
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        std::array<int, 3> axes = {0, 1, 2};
        do {
          Eigen::Vector3i corner(i, j, k);
          std::array<int, 4> t = {number(corner)};
          for (int s = 0; s < 3; ++s) {
            ++corner[axes[s]];
            t[s + 1] = number(corner);
          }
          mesh.tetrahedra.push_back(t);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  orient(mesh);
  return mesh;
}

TetrahedralMesh box(const Planes& planes) {
  Eigen::Vector3i cells;
  for (int axis = 0; axis < 3; ++axis) cells[axis] = static_cast<int>(planes[axis].size()) - 1;
  TetrahedralMesh mesh = box(cells, cells.cast<double>());
  for (Eigen::Vector3d& x : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) x[axis] = planes[axis][std::lround(x[axis])];
  }
  return mesh;
}

namespace {

// planes from 0 to pieces of so many even cells each
struct Piece {
  double end;
  int cells;
};

std::vector<double> even_planes(std::initializer_list<Piece> pieces) {
  std::vector<double> planes{0};
  for (const Piece& piece : pieces) {
    const double begin = planes.back();
    for (int i = 1; i <= piece.cells; ++i) planes.push_back(begin + (piece.end - begin) * i / piece.cells);
  }
  return planes;
}

// goes on with cells that grow by the same factor
void add_growing(double end, int cells, std::vector<double>& planes) {
  const double even = planes.back() - planes[planes.size() - 2];
  const auto reach = [&](double factor) {
    double length = 0;
    for (int i = 1; i <= cells; ++i) length += even * std::pow(factor, i);
    return length;
  };
  const double way = end - planes.back();
  double low = 1e-3, high = 1e3;  // of the factor
  for (int i = 0; i < 100; ++i) {
    const double between = std::sqrt(low * high);
    (reach(between) < way ? low : high) = between;
  }
  for (int i = 1; i <= cells; ++i) planes.push_back(planes.back() + even * std::pow(low, i));
  planes.back() = end;
}

std::vector<double> mirrored(const std::vector<double>& from_axis) {
  std::vector<double> planes;
  for (std::size_t i = from_axis.size() - 1; i > 0; --i) planes.push_back(-from_axis[i]);
  planes.insert(planes.end(), from_axis.begin(), from_axis.end());
  return planes;
}

constexpr double half_middle = 4e-3, half_pad = 10e-3;

std::vector<double> pad_layers(int layers) {
  constexpr double height = 3e-3, lowest_over_highest = 4;
  const double thinner = std::pow(lowest_over_highest, -1.0 / layers);
  const double sum = (1 - 1 / lowest_over_highest) / (1 - thinner);
  std::vector<double> planes;
  for (int i = 0; i <= layers; ++i) planes.push_back(height * (1 - std::pow(thinner, i)) / (1 - thinner) / sum);
  planes.back() = height;
  return planes;
}

}  // namespace

Planes gel_pad(int middle, int rim, int layers) {
  std::vector<double> across = even_planes({{half_middle, middle / 2}});
  add_growing(half_pad, rim, across);
  return {mirrored(across), mirrored(across), pad_layers(layers)};
}

Planes edge_pad(int fine) {
  constexpr double beside = 1e-3, end_begins = 2e-3, end_ends = 10e-3 / 3;
  std::vector<double> across = even_planes({{beside, 6 * fine}, {half_middle, 9 * fine}});
  add_growing(half_pad, 5 * fine, across);
  std::vector<double> along = even_planes({{end_begins, 4 * fine}, {end_ends, 8 * fine}, {half_middle, 2 * fine}});
  add_growing(half_pad, 6 * fine, along);
  return {mirrored(across), mirrored(along), pad_layers(4 * fine)};
}

TetrahedralMesh shell(int levels, int layers, double inner, double outer) {
  const auto sphere = ellipsoid(levels, Eigen::Vector3d::Ones());
  const auto triangles = triangles_of_level(sphere, levels);
  const int per_layer = static_cast<int>(sphere.positions.size());
  TetrahedralMesh mesh;
  for (int l = 0; l <= layers; ++l) {
    const double radius = inner * std::pow(outer / inner, static_cast<double>(l) / layers);
    for (const auto& x : sphere.positions) mesh.vertices.emplace_back(radius * x);
  }
  for (int l = 0; l < layers; ++l) {
    for (const auto& t : triangles) {
      std::array<int, 3> low = t, high = t;
      for (int k = 0; k < 3; ++k) {
        low[k] += l * per_layer;
        high[k] += (l + 1) * per_layer;
      }
      cut_prism(low, high, mesh);
    }
  }
  orient(mesh);
  return mesh;
}

}  // namespace greenloop::offline::testing
