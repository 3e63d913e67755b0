#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/progress.hpp"
#include "offline/remesh/quality.hpp"

namespace greenloop::offline {

/// What to make of a surface.
struct RemeshOptions {
  int base_vertices = 42;  ///< of the first attempt; at least 4
  /// How far an attempt that fails `accuracy` or `smallest_angle` may grow the base; if not set, eightfold.
  std::optional<int> most_base_vertices;
  int levels = 3;  ///< midpoint splits of the base, 0 to 7
  /// Greatest Hausdorff distance, as a share of the bounding box's diagonal; if not set, 2 % at three levels, halved
  /// with each further one.
  std::optional<double> accuracy;
  double smallest_angle = 8;      ///< degrees, on the finest level
  bool keep_connectivity = true;  ///< keep a surface that has subdivision connectivity as it is
  /// Bound on the work of all attempts, in attempts at base_vertices over even triangles, or over the input if it is
  /// finer.
  double most_work = 9;
};

/// The edge of even triangles that the finest level over base_vertices makes of so much area, in its unit.
[[nodiscard]] double finest_edge(double area, const RemeshOptions& options);

/// A surface with subdivision connectivity and what it is worth.
struct Remeshed {
  SemiRegularMesh mesh;
  RemeshQuality quality;
};

/// No base will do. what() says what was reached and what to change.
class RemeshError : public std::runtime_error {
 public:
  RemeshError(const std::string& what, const RemeshQuality& best) : std::runtime_error(what), best_(best) {}

  [[nodiscard]] const RemeshQuality& best() const { return best_; }

 private:
  RemeshQuality best_;
};

/// Gives a closed, connected, manifold, outward oriented surface of any genus subdivision connectivity.
/// If it has such connectivity already, its vertices are kept exactly, with as many levels as it has, options.levels at
/// most (quality.levels says how many). Otherwise it is decimated to a base whose bijection with the input is kept
/// (see decimate), the base is split at midpoints, and the vertices slide along the input until the triangles are
/// even (see relax): every vertex lies on the input. An input with no more vertices than the base may have is itself
/// the base, or its splits that are no larger, and is reproduced exactly. A base too small for the shape is grown step
/// by step until accuracy and smallest angle hold and nothing is flipped or self-intersecting; the fraction told to
/// `progress` does not go back. The same input and options give the same bits. Needs memory and time linear in input
/// plus result. Throws std::invalid_argument on impossible options or an input that is not closed and manifold, and
/// RemeshError, naming what was reached and what to change, if no base of at most most_base_vertices will do.
[[nodiscard]] Remeshed remesh(const TriangleMesh& input, const RemeshOptions& options, const Progress& progress = {});

/// A closed surface, manifold and outward oriented, in even triangles of about `edge_length` (its unit), or shorter
/// where that leaves fewer than a hundred: a wall inside a body, which carries no nodes. Its sharp lines are kept. Work
/// as of even_mesh. Throws std::runtime_error if it does not come to even triangles.
[[nodiscard]] TriangleMesh even_surface(const TriangleMesh& input, double edge_length);

}  // namespace greenloop::offline
