#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {

/// A tree of boxes over the triangles of a mesh, in double precision. Keeps a reference to the mesh.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  /// The closest place of the mesh. Work: about logarithmic in the triangles.
  [[nodiscard]] SurfacePoint closest(const Eigen::Vector3d& point) const;
  /// Distance to the mesh, or any upper bound of it that is not above `enough`.
  [[nodiscard]] double distance(const Eigen::Vector3d& point, double enough = 0) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, count;  ///< triangles order_[first .. first + count) in a leaf; count = 0 in an inner node
    int left, right;
  };
  struct Nearest {
    double squared_distance;
    SurfacePoint place;
  };

  int build(int first, int count, std::vector<Eigen::AlignedBox3d>& boxes);
  void search(int node, const Eigen::Vector3d& point, double enough, Nearest& nearest) const;

  const TriangleMesh& mesh_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace greenloop::offline
