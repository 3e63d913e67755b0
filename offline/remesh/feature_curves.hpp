#pragma once

#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {

/// A sharp line of a surface: a path along edges, from corner to corner or once around.
struct FeatureChain {
  std::vector<int> vertices;    ///< in order; of a loop without a corner, the first stands at the end again
  std::vector<double> lengths;  ///< along the chain up to each of `vertices`
  bool loop = false;            ///< closed, and without a corner
};

/// Where the drawing of a surface has edges and corners.
struct Features {
  std::vector<FeatureChain> chains;
  std::vector<char> corners;  ///< per vertex, 1 where chains end, meet or turn sharply

  [[nodiscard]] std::size_t corner_count() const;
};

/// Chains of the edges at which a closed manifold surface turns by more than `degrees`; chains with a loose end, and
/// loops, shorter than `shortest` are left out as noise. A chain has a corner where it turns by more than 50 degrees.
/// Work: n log n in the triangles. Throws std::invalid_argument if the mesh is not closed and manifold.
[[nodiscard]] Features find_features(const TriangleMesh& mesh, double degrees, double shortest);

/// A place on a chain, by the length along it; at a corner; or none.
struct CurvePoint {
  static constexpr int kFree = -1, kCorner = -2;
  int chain = kFree;
  double along = 0;
  int corner = -1;  ///< the mesh's vertex
};

/// A place on a surface that is bound to a chain or a corner, or free.
struct BoundPoint {
  SurfacePoint point;
  CurvePoint curve;
};

/// The chains of a mesh as curves to move along. Keeps a reference to the mesh.
class FeatureCurves {
 public:
  FeatureCurves(const TriangleMesh& mesh, const std::vector<FeatureChain>& chains);

  [[nodiscard]] const std::vector<FeatureChain>& chains() const { return chains_; }
  [[nodiscard]] SurfacePoint point(const CurvePoint& place) const;
  [[nodiscard]] Eigen::Vector3d tangent(const CurvePoint& place) const;
  /// `by` further along; stops at the ends of a chain, goes around a loop.
  [[nodiscard]] CurvePoint moved(const CurvePoint& place, double by) const;
  /// The place on the chain closest to x. Work: linear in the chain.
  [[nodiscard]] CurvePoint closest(int chain, const Eigen::Vector3d& x) const;
  /// The length from a place on a chain to another on it, negative against its direction; the shorter way around a
  /// loop, the nearer end of a chain that ends where it starts.
  [[nodiscard]] double way(const CurvePoint& from, const CurvePoint& to) const;

 private:
  struct Segment {
    std::size_t index;
    double share;
  };
  [[nodiscard]] Segment segment(const CurvePoint& place) const;
  [[nodiscard]] double whole(int chain) const { return chains_[chain].lengths.back(); }

  const TriangleMesh& mesh_;
  std::vector<FeatureChain> chains_;
  std::vector<std::vector<std::array<int, 2>>> sides_;  ///< of each segment: a triangle, and its edge
};

/// Which edges of a triangulation that changes lie on chains.
class FeatureLinks {
 public:
  FeatureLinks(const Features& features, std::size_t vertices);

  [[nodiscard]] bool is_free(int v) const { return links_[v].empty(); }
  [[nodiscard]] bool is_corner(int v) const { return corners_[v] != 0; }
  /// The chain that the edge (v, w) lies on; CurvePoint::kFree if none.
  [[nodiscard]] int chain(int v, int w) const;
  /// Whether `removed` may become one with its neighbour `kept`, which stays where it is.
  [[nodiscard]] bool may_collapse(int removed, int kept) const;
  /// The neighbour of a vertex inside a chain that is not `other`.
  [[nodiscard]] int beyond(int v, int other) const;
  /// Both neighbours of a vertex inside a chain.
  [[nodiscard]] std::array<int, 2> along(int v) const { return {links_[v][0].vertex, links_[v][1].vertex}; }
  void collapse(int removed, int kept);
  /// `middle` (one past the last vertex) comes to lie on the edge (v, w).
  void split(int v, int w, int middle);
  /// Chains again, over `renumbered` vertices at `positions`.
  [[nodiscard]] Features features(const std::vector<int>& renumbered,
                                  const std::vector<Eigen::Vector3d>& positions) const;

 private:
  struct Link {
    int vertex, chain;
  };
  void relink(int v, int from, int to);

  std::vector<std::vector<Link>> links_;
  std::vector<char> corners_;
};

}  // namespace greenloop::offline
