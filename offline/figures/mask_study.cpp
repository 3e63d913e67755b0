#include "offline/figures/mask_study.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "offline/report/mask_figure.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"
#include "offline/surface/linear_mask.hpp"
#include "offline/surface/lumped_areas.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Material material{1e6, 0.4};
constexpr std::size_t at_once = 32;  // vertices

std::vector<int> free_vertices(const Nodule& nodule) {
  std::vector<int> free;
  for (std::size_t v = 0; v < nodule.fixed.size(); ++v) {
    if (nodule.fixed[v] == 0) free.push_back(static_cast<int>(v));
  }
  return free;
}

// those of the surface come first
std::vector<std::uint8_t> in_volume(std::vector<std::uint8_t> fixed, std::size_t vertices) {
  fixed.resize(vertices, 0);
  return fixed;
}

// where a ray from the origin meets the surface
struct SurfacePoint {
  std::array<int, 3> corner;
  Vector3d weight;
};

SurfacePoint meet(const TriangleMesh& surface, const Vector3d& direction) {
  SurfacePoint best{};
  double inside = -1;
  for (const std::array<int, 3>& triangle : surface.triangles) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = surface.vertices[triangle[k]];
    const Vector3d along = corners.inverse() * direction;
    const double sum = along.sum();
    if (sum > 0 && along.minCoeff() / sum > inside) {
      inside = along.minCoeff() / sum;
      best = {triangle, along / sum};
    }
  }
  return best;
}

SvgCanvas picture(const Nodule& nodule, const std::string& name, const std::string& unit,
                  const std::vector<double>& value) {
  const VisibleSurface surface{
      nodule.surface.vertices, nodule.surface.triangles, {nodule.fixed.begin(), nodule.fixed.end()}};
  return value_panel(surface, view_frame({1, 0, 0.7}, {0, 0, 1}), name, unit, value);
}

SvgCanvas sliding_panel(const SlidingForce& force) {
  const std::vector<LegendEntry> legend = {{"single vertices", {paint::muted, 1.5}, false},
                                           {"masked vertices", {paint::blue, 1.5}, false},
                                           {"held masks", {paint::vermilion, 2.5}, false}};
  const PanelFrame frame = panel_frame(false, legend, 230);
  SvgCanvas canvas(panel_width, frame.height, "Sliding around the axis",
                   "normal force of a point that slides at constant depth", panel_text);
  const double most = std::max({*std::max_element(force.single.begin(), force.single.end()),
                                *std::max_element(force.masked.begin(), force.masked.end()),
                                *std::max_element(force.held.begin(), force.held.end())});
  SvgPlot plot(canvas, frame.area, {"angle around the axis [°]", 0, 360},
               axis_from_zero("force per depth", "N/m", most));
  const auto data = [&](const std::vector<double>& values) {
    std::vector<Point> points;
    for (std::size_t k = 0; k < values.size(); ++k) {
      points.push_back({180 / std::numbers::pi * force.azimuth[k], values[k]});
    }
    return points;
  };
  plot.curve(data(force.single), legend[0].stroke);
  plot.curve(data(force.masked), legend[1].stroke);
  plot.curve(data(force.held), legend[2].stroke);
  plot.legend(legend);
  return canvas;
}

std::vector<double> norms(MaskedBody& body, double radius, MaskedBody::Of of) {
  std::vector<double> norm(body.nodule().fixed.size(), 0.0);
  const std::vector<Matrix3d> stiffness = body.stiffness(body.free_nodes(), radius, of);
  for (std::size_t k = 0; k < stiffness.size(); ++k) {
    norm[static_cast<std::size_t>(body.free_nodes()[k])] = stiffness[k].norm();
  }
  return norm;
}

}  // namespace

MaskedBody::MaskedBody(Nodule nodule, Elements elements)
    : MaskedBody(nodule, tetrahedralize(nodule.surface).mesh, elements) {}

MaskedBody::MaskedBody(Nodule nodule, TetrahedralMesh volume, Elements elements)
    : nodule_(std::move(nodule)),
      area_(lumped_areas(nodule_.surface)),
      free_(free_vertices(nodule_)),
      volume_(std::move(volume)),
      volume_fixed_(in_volume(nodule_.fixed, volume_.vertices.size())),
      interpolation_(select_first_vertices(static_cast<int>(nodule_.surface.vertices.size()),
                                           static_cast<int>(volume_.vertices.size()))),
      source_({volume_, volume_fixed_, interpolation_, material, free_, free_, elements}) {}

void MaskedBody::add_mask(int node, double radius, int column, std::vector<Eigen::Triplet<double>>& entries) const {
  const std::vector<Vector3d>& at = nodule_.surface.vertices;
  if (radius == 0) {
    entries.emplace_back(node, column, 1);
    return;
  }
  std::vector<double> share(at.size(), 0.0);
  for (const std::array<int, 3>& triangle : nodule_.surface.triangles) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = at[triangle[k]];
    const Vector3d part = mask_integrals(corners, at[node], radius);
    for (int k = 0; k < 3; ++k) share[triangle[k]] += part(k);
  }
  double sum = 0;
  for (const int j : free_) sum += share[j];
  for (const int j : free_) {
    if (share[j] > 0) entries.emplace_back(j, column, share[j] / sum);
  }
}

std::vector<Matrix3d> MaskedBody::stiffness(std::span<const int> nodes, double radius, Of of) {
  std::vector<Matrix3d> all;
  for (std::size_t first = 0; first < nodes.size(); first += at_once) {
    const std::span<const int> some = nodes.subspan(first, std::min(at_once, nodes.size() - first));
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < some.size(); ++k)
      add_mask(some[k], of == Of::vertex ? 0 : radius, static_cast<int>(k), entries);
    Eigen::SparseMatrix<double> patterns(static_cast<Index>(area_.size()), static_cast<Index>(some.size()));
    patterns.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixXd moved = source_.displacement(patterns);
    for (std::size_t k = 0; k < some.size(); ++k) {
      const auto column = static_cast<Index>(k);
      Matrix3d compliance = Matrix3d::Zero();
      for (Eigen::SparseMatrix<double>::InnerIterator part(patterns, column); part; ++part) {
        const double weight = of == Of::held_mask ? part.value() : part.row() == some[k] ? 1 : 0;
        const Index row = std::lower_bound(free_.begin(), free_.end(), part.row()) - free_.begin();
        compliance += weight * moved.block<3, 3>(3 * row, 3 * column);
      }
      all.emplace_back(compliance.inverse());
    }
  }
  return all;
}

std::vector<RefinedStiffness> refine_stiffness(int splits, double radius, Elements elements,
                                               const std::function<void(int)>& progress) {
  std::vector<RefinedStiffness> rows;
  for (int level = 1; level <= splits; ++level) {
    if (progress) progress(level);
    MaskedBody body(make_nodule({.splits = level}), elements);
    const std::vector<int> top = {0};
    const double edge = mean_edge(body.nodule().surface);
    const double mask = radius * (rows.empty() ? edge : rows.front().edge);
    const auto norm = [&](MaskedBody::Of of) { return body.stiffness(top, mask, of)[0].norm(); };
    rows.push_back({static_cast<int>(body.area().size()), edge, norm(MaskedBody::Of::vertex),
                    norm(MaskedBody::Of::masked_vertex), norm(MaskedBody::Of::held_mask)});
  }
  return rows;
}

double SlidingForce::ripple(const std::vector<double>& force) {
  const auto [least, most] = std::minmax_element(force.begin(), force.end());
  double sum = 0;
  for (const double one : force) sum += one;
  return (*most - *least) * static_cast<double>(force.size()) / sum;
}

SlidingForce slide_around(MaskedBody& body, double polar, double radius, int points) {
  SlidingForce force;
  std::vector<SurfacePoint> way;
  std::vector<int> nodes;
  for (int k = 0; k < points; ++k) {
    force.azimuth.push_back(2 * std::numbers::pi * k / points);
    way.push_back(meet(body.nodule().surface, nodule_point(polar, force.azimuth.back())));
    nodes.insert(nodes.end(), way.back().corner.begin(), way.back().corner.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const auto slide = [&](MaskedBody::Of of) {
    const std::vector<Matrix3d> of_node = body.stiffness(nodes, radius, of);
    std::vector<double> along;
    for (std::size_t k = 0; k < way.size(); ++k) {
      Matrix3d stiffness = Matrix3d::Zero();
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = std::lower_bound(nodes.begin(), nodes.end(), way[k].corner[c]) - nodes.begin();
        stiffness += way[k].weight(static_cast<Index>(c)) * of_node[static_cast<std::size_t>(at)];
      }
      const Vector3d normal = nodule_normal(polar, force.azimuth[k]);
      along.push_back(normal.dot(stiffness * normal));
    }
    return along;
  };
  force.single = slide(MaskedBody::Of::vertex);
  force.masked = slide(MaskedBody::Of::masked_vertex);
  force.held = slide(MaskedBody::Of::held_mask);
  return force;
}

Figure masks_figure(MaskedBody& body, double radius, const SlidingForce& force) {
  Figure figure{"masks",
                "Point-like contact without and with masks",
                "Area of every vertex of an uneven triangulation, stiffness of every free vertex by itself and under a "
                "mask, and the normal force of a point that slides once around the axis at constant depth.",
                {}};
  figure.panels.push_back(picture(body.nodule(), "Area of a vertex", "m²", body.area()));
  figure.panels.push_back(
      picture(body.nodule(), "Stiffness of a single vertex", "N/m", norms(body, radius, MaskedBody::Of::vertex)));
  figure.panels.push_back(
      picture(body.nodule(), "Masked stiffness", "N/m", norms(body, radius, MaskedBody::Of::masked_vertex)));
  figure.panels.push_back(sliding_panel(force));
  return figure;
}

}  // namespace greenloop::offline
