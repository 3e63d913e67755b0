#include "formats/testing/synthetic_multigrid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace greenloop {
namespace {

constexpr std::uint32_t corners_of_slice = 4;
constexpr float side = 0.01F;                                       // m
constexpr layout::MatterRecord rubber{5.0e4F, 5.0e4F, 1000.0F, 0};  // Pa, kg/m^3
constexpr double time_step = 1.0e-3;                                // s

/// Vertex of slice x at y, z of 0 and 1; the held slice is numbered last.
std::uint32_t vertex(std::uint32_t cells, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const std::uint32_t slice = x == 0 ? cells : x - 1;
  return corners_of_slice * slice + 2 * z + y;
}

void add_cube(std::uint32_t cells, std::uint32_t x, MultigridData& model) {
  // from one corner to the opposite one along the axes in each order; odd orders are turned over
  constexpr std::array<std::array<std::uint32_t, 3>, 6> orders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  for (std::size_t i = 0; i < orders.size(); ++i) {
    std::uint32_t at[3] = {x, 0, 0};
    layout::TetrahedronRecord record{};
    record.vertex[0] = vertex(cells, at[0], at[1], at[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      ++at[orders[i][k]];
      record.vertex[k + 1] = vertex(cells, at[0], at[1], at[2]);
    }
    if (i >= 3) std::swap(record.vertex[1], record.vertex[2]);
    model.tetrahedra.push_back(record);
  }
}

void add_diagonal(float value, std::vector<float>& blocks) {
  for (std::size_t i = 0; i < 12; ++i) blocks.push_back(i % 5 == 0 ? value : 0.0F);
}

/// Rows of neighbours in the numbering, whose blocks are 0, and of each vertex one parent of the half as many.
GridData grid_of(std::uint32_t vertices, float stiffness) {
  GridData grid;
  grid.row_starts.push_back(0);
  grid.parent_starts.push_back(0);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (v > 0) grid.columns.push_back(v - 1);
    grid.row_uppers.push_back(static_cast<std::uint32_t>(grid.columns.size()));
    if (v + 1 < vertices) grid.columns.push_back(v + 1);
    grid.row_starts.push_back(static_cast<std::uint32_t>(grid.columns.size()));
    add_diagonal(1 / stiffness, grid.inverses);
    grid.parents.push_back(v / 2);
    grid.weights.push_back(1);
    grid.parent_starts.push_back(v + 1);
  }
  grid.blocks.assign(12 * grid.columns.size(), 0.0F);
  return grid;
}

}  // namespace

MultigridData synthetic_multigrid(const SyntheticMultigrid& options) {
  const std::uint32_t cells = options.cells;
  MultigridData model;
  model.provenance = "{}";
  model.info.strain = static_cast<std::uint32_t>(options.strain);
  model.info.free = corners_of_slice * cells;
  model.info.time_step = time_step;
  model.info.stiffness_damping = 1.0e-3F;
  model.info.numerical_damping = 0.1F;
  model.info.size = side * std::sqrt(static_cast<float>(cells * cells + 2));
  model.info.gravity[2] = -9.81F;
  model.points.resize(std::size_t{3} * corners_of_slice * (cells + 1));
  for (std::uint32_t x = 0; x <= cells; ++x) {
    for (std::uint32_t corner = 0; corner < corners_of_slice; ++corner) {
      float* const point = model.points.data() + std::size_t{3} * vertex(cells, x, corner % 2, corner / 2);
      point[0] = side * static_cast<float>(x);
      point[1] = side * static_cast<float>(corner % 2);
      point[2] = side * static_cast<float>(corner / 2);
    }
    if (x < cells) add_cube(cells, x, model);
  }
  model.matters = {rubber};
  // what is shown: a triangle at the end
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t v = vertex(cells, cells, k % 2, k / 2);
    for (std::size_t i = 0; i < 3; ++i) model.shown_points.push_back(model.points[std::size_t{3} * v + i]);
    model.bindings.push_back({{v, v, v, v}, {1, 0, 0, 0}});
    model.shown_triangles.push_back(k);
  }
  const float stiffness = 4.0F * rubber.density * side * side * side / static_cast<float>(time_step * time_step);
  std::uint32_t vertices = model.info.free;
  for (std::uint32_t g = 0; g + 1 < options.grids; ++g) {
    model.grids.push_back(grid_of(vertices, stiffness));
    vertices = (vertices + 1) / 2;
  }
  model.coarsest_vertices = vertices;
  for (std::uint32_t row = 0; row < 3 * vertices; ++row) {
    model.coarsest_factor.insert(model.coarsest_factor.end(), row, 0.0);
    model.coarsest_factor.push_back(1 / std::sqrt(static_cast<double>(stiffness)));
  }
  return model;
}

}  // namespace greenloop
