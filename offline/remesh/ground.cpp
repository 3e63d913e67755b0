#include "offline/remesh/ground.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <utility>

#include "offline/remesh/midpoint_refinement.hpp"
#include "offline/remesh/relaxation.hpp"

namespace greenloop::offline {
namespace {

/// Fewer levels than this leave triangles too large to be shaped by the surface below them.
constexpr int kWorkingLevels = 3;

std::vector<std::array<int, 2>> edges_of(const Features& features) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& chain : features.chains) {
    for (std::size_t k = 1; k < chain.vertices.size(); ++k) edges.push_back({chain.vertices[k - 1], chain.vertices[k]});
  }
  return edges;
}

/// The chain that each vertex of a refined base lies on: that of the edge it splits.
std::vector<int> chains_of(const SemiRegularMesh& mesh, const Features& base) {
  std::map<std::pair<int, int>, int> chain_of_edge;
  std::vector<int> chains(mesh.parents.size(), CurvePoint::kFree);
  for (std::size_t c = 0; c < base.chains.size(); ++c) {
    const auto& vertices = base.chains[c].vertices;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      chains[vertices[k]] = static_cast<int>(c);
      if (k > 0) chain_of_edge[std::minmax(vertices[k - 1], vertices[k])] = static_cast<int>(c);
    }
  }
  for (std::size_t v = 0; v < base.corners.size(); ++v) {
    if (base.corners[v] != 0) chains[v] = CurvePoint::kCorner;
  }
  for (int v = static_cast<int>(mesh.vertex_end[0]); v < static_cast<int>(mesh.parents.size()); ++v) {
    const auto& [a, b] = mesh.parents[v];
    const auto split = chain_of_edge.find(std::minmax(a, b));
    if (split == chain_of_edge.end()) continue;
    chains[v] = split->second;
    chain_of_edge[std::minmax(a, v)] = chain_of_edge[std::minmax(b, v)] = chains[v];
  }
  return chains;
}

/// A place on the surface for every vertex of it.
std::vector<SurfacePoint> vertex_places(const TriangleMesh& mesh) {
  std::vector<SurfacePoint> places(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) places[mesh.triangles[t][c]] = {static_cast<int>(t), Eigen::Vector3d::Unit(c)};
  }
  return places;
}

}  // namespace

Ground::Ground(TriangleMesh input) : input_(std::move(input)), input_curves_(input_.mesh(), {}) {}

Ground::Ground(TriangleMesh input, const Features& features, double edge_length)
    : input_(std::move(input), edges_of(features)), input_curves_(input_.mesh(), features.chains) {
  input_tree_.emplace(input_.mesh());
  even_ = even_mesh(input_, features, input_curves_, edge_length);
  even_surface_.emplace(even_->mesh, edges_of(even_->features));
  even_curves_.emplace(even_surface_->mesh(), even_->features.chains);
}

SelfParameterization Ground::base(int vertices) const {
  return decimate(surface().mesh(), vertices, even_ ? even_->features : Features{});
}

Ground::Attempt Ground::attempt(const SelfParameterization& parameterization, int levels, double least_angle,
                                const std::function<void(double)>& progress) const {
  auto refinement =
      refine_midpoints(parameterization.base_triangles, static_cast<int>(parameterization.base_vertices.size()),
                       std::max(levels, kWorkingLevels));
  const auto on_surface = parameterization.to_input(std::move(refinement.places));
  const auto chains = chains_of(refinement.mesh, parameterization.base_features);
  const auto corners = even_ ? vertex_places(surface().mesh()) : std::vector<SurfacePoint>{};
  std::vector<BoundPoint> points;
  for (std::size_t v = 0; v < on_surface.size(); ++v) {
    if (chains[v] == CurvePoint::kFree) {
      points.push_back({on_surface[v], {}});
    } else if (chains[v] == CurvePoint::kCorner) {
      points.push_back({corners[parameterization.base_origin[v]], {CurvePoint::kCorner, 0, -1}});
    } else {
      const auto curve = curves().closest(chains[v], surface().position(on_surface[v]));
      points.push_back({curves().point(curve), curve});
    }
  }
  points = relax(surface(), curves(), refinement.mesh, std::move(points), parameterization.base_planes,
                 levels < kWorkingLevels ? 0 : least_angle, progress);
  Attempt result{truncated(std::move(refinement.mesh), levels), {}};
  for (std::size_t v = 0; v < result.mesh.positions.size(); ++v) {
    result.places.push_back(even_ ? even_->on_original(points[v], input_curves_, *input_tree_) : points[v].point);
  }
  return result;
}

}  // namespace greenloop::offline
