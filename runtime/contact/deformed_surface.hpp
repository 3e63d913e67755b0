#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"
#include "runtime/surface.hpp"
#include "runtime/surface/parts.hpp"

namespace greenloop {

/// A point of a surface by its own coordinates, which stay when the surface is deformed.
struct TrianglePoint {
  std::uint32_t triangle = layout::none;  ///< of the surface's own level; none: there is no such point
  double weight[3] = {};                  ///< of its corners, in 0..1 with sum 1
};

struct ClosestSurfacePoint {
  TrianglePoint point;
  double squared_distance = 0;  ///< m^2
};

/// What queries of a deformed surface cost, in work units: about instructions of an x86-64 processor.
struct SurfacePrices {
  static constexpr std::uint64_t query = 100;     ///< a question, whatever is found
  static constexpr std::uint64_t box = 145;       ///< a box that is looked at
  static constexpr std::uint64_t triangle = 260;  ///< a triangle
  static constexpr std::uint64_t boxed = 16;      ///< a triangle whose patch's box is made anew
  static constexpr std::uint64_t patch = 65;      ///< such a box, and one above it
  static constexpr std::uint64_t neighbour = 12;  ///< a triangle around a node
};

/// No limit of a query's work.
inline constexpr std::uint64_t all_work = ~std::uint64_t{0};

/// What bounds the work of queries: known before there is a surface.
struct SurfaceSizes {
  std::uint64_t triangles = 0, patches = 0;
  std::uint64_t most_around = 0;  ///< triangles around a node

  /// Of making all boxes anew.
  [[nodiscard]] std::uint64_t update_work() const noexcept {
    return SurfacePrices::query + triangles * SurfacePrices::boxed + patches * SurfacePrices::patch;
  }
  /// Of finding the triangles around a point, at most.
  [[nodiscard]] std::uint64_t around_work() const noexcept { return most_around * SurfacePrices::neighbour; }
  /// Of a normal, at most.
  [[nodiscard]] std::uint64_t surround_work() const noexcept {
    return SurfacePrices::query + most_around * SurfacePrices::triangle + around_work();
  }
};

/// The surface of a Surface's own level, displaced. Its triangles stand in *patches* of at most 16 that are neighbours,
/// and these in the upper levels of the Surface's tree, whose boxes are made anew for a displacement. Everything is in
/// the caller's memory, which, like that of the Surface, must outlive it. The same questions give the same bits
/// everywhere.
class DeformedSurface {
 public:
  struct Created;

  /// Of no use before `create`.
  DeformedSurface() = default;

  /// Bytes, for a surface or for the one that Surface::create makes of a model and a level. Start-up; constant work.
  [[nodiscard]] static std::size_t required(const Surface& surface) noexcept;
  [[nodiscard]] static std::size_t required(const Model& model, std::uint32_t level) noexcept;

  /// Of the surface that Surface::create makes of a model and a level, and of this one. Start-up; linear in the base
  /// triangles for every 256 nodes of the base.
  [[nodiscard]] static SurfaceSizes sizes(const Model& model, std::uint32_t level) noexcept;
  [[nodiscard]] SurfaceSizes sizes() const noexcept {
    return {triangle_count(), first_patch_ + std::uint64_t{1}, most_around_};
  }

  /// Carves `memory`, 64-byte aligned, with the routine that `required` counts with; the surface is at rest. Start-up;
  /// linear in the triangles.
  [[nodiscard]] static Created create(const Surface& surface, std::span<std::byte> memory) noexcept;

  /// From here on the surface is displaced by this, x y z 0 in m for each node and perhaps more of them; empty: it is
  /// at rest. The numbers must stay as they are until the next update. With too few of them nothing changes, and it is
  /// false. For the loop; work: update_work(), which is added to `work`, linear in the triangles.
  bool update(std::span<const Vec4> displacement, std::uint64_t& work) noexcept;
  [[nodiscard]] std::uint64_t update_work() const noexcept { return sizes().update_work(); }

  [[nodiscard]] std::uint32_t node_count() const noexcept { return parts_->node_count[parts_->level]; }
  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return parts_->base_triangles << (2 * parts_->level); }
  [[nodiscard]] const Surface::Triangle& triangle(std::uint32_t t) const noexcept { return parts_->triangles[t]; }
  [[nodiscard]] bool is_touchable(std::uint32_t node) const noexcept {
    return (parts_->nodes[node].flags & layout::node_touchable) != 0;
  }

  /// m, displaced. Constant work.
  [[nodiscard]] Double3 position(std::uint32_t node) const noexcept {
    const float* x = parts_->nodes[node].position;
    const Double3 rest{x[0], x[1], x[2]};
    if (displacement_ == nullptr) return rest;
    const Vec4& u = displacement_[node];
    return rest + Double3{u.x, u.y, u.z};
  }
  [[nodiscard]] Double3 position(const TrianglePoint& point) const noexcept;

  /// Outward unit normals: of a triangle; of a node, the mean of the triangles' around it by area; of a point of the
  /// surface, the triangle's or, on an edge or a corner, that by whose side inside and outside are told apart for what
  /// has its closest point there: the mean by angle (Baerentzen & Aanaes 2005). Zero where triangles have no area.
  /// Work: a `triangle` for each triangle around it, at most surround_work(), is added to `work`.
  [[nodiscard]] Double3 triangle_normal(std::uint32_t t) const noexcept;
  [[nodiscard]] Double3 node_normal(std::uint32_t node, std::uint64_t& work) const noexcept;
  [[nodiscard]] Double3 normal(const TrianglePoint& point, std::uint64_t& work) const noexcept;
  [[nodiscard]] std::uint64_t surround_work() const noexcept { return sizes().surround_work(); }
  [[nodiscard]] std::uint64_t around_work() const noexcept { return sizes().around_work(); }

  /// Around the whole surface.
  [[nodiscard]] const TriangleBox& box() const noexcept { return boxes_[0]; }
  /// m, how far it reaches from the origin, as a sum over x, y and z.
  [[nodiscard]] double extent() const noexcept { return extent_; }
  /// Whether a position (m) lies in the box around the whole surface, or less than `margin` beside it. Constant work.
  [[nodiscard]] bool is_near(const Double3& position, double margin) const noexcept;

  /// The point nearest to a finite position (m), of equally near triangles in the first; exact up to rounding. The
  /// triangle `guess`, if it is not none, is looked at first, which saves work and changes nothing else. For the loop;
  /// work: what was looked at is added to `work`; at most closest_work(), which is all boxes and all triangles. Once
  /// `work` is above `most` the search is cut: the point is the nearest of those that were looked at, if any. Then
  /// `work` is above `most` by no more than patch_work.
  [[nodiscard]] ClosestSurfacePoint closest(const Double3& position, std::uint32_t guess, std::uint64_t& work,
                                            std::uint64_t most = all_work) const noexcept;
  [[nodiscard]] std::uint64_t closest_work() const noexcept {
    return SurfacePrices::query + box_count() * SurfacePrices::box +
           (triangle_count() + std::uint64_t{1}) * SurfacePrices::triangle;
  }
  /// The point of one triangle nearest to a position. Constant work.
  [[nodiscard]] ClosestSurfacePoint closest_in(std::uint32_t t, const Double3& position) const noexcept;

  /// Calls look(patch) for every patch in boxes that all are entered, in the order of the tree. enters(box): whether to
  /// look into it. For the loop; work: at most all boxes, box_count().
  template <class Enters, class Look>
  void visit(Enters enters, Look look) const noexcept;
  [[nodiscard]] std::uint64_t box_count() const noexcept { return 2 * std::uint64_t{first_patch_} + 1; }

  /// The same, of boxes with beyond(box) <= 0 inside others of which that holds, the less of two halves first.
  template <class Beyond, class Look>
  void visit_nearer_first(Beyond beyond, Look look) const noexcept;

  /// The triangles of a patch, and those of its nodes that no patch before it has.
  [[nodiscard]] std::span<const std::uint32_t> triangles_of(std::uint32_t patch) const noexcept {
    return parts_->tree.in(patch);
  }
  [[nodiscard]] std::span<const std::uint32_t> own_nodes_of(std::uint32_t patch) const noexcept {
    const Nodes& nodes = nodes_[patch - first_patch_];
    return {node_ + nodes.begin, node_ + nodes.own_end};
  }

  /// Calls visit(triangle) for all that a point of the surface lies in: itself, those at an edge, those around a node.
  /// Work: at most around_work().
  template <class Visit>
  void visit_around(const TrianglePoint& point, Visit visit) const noexcept;

 private:
  static constexpr std::uint32_t halvings_within = 2;  ///< of the tree, between a patch and its leaves
  static constexpr std::uint32_t most_in_patch = TriangleTree::leaf << halvings_within;

 public:
  /// What a query takes at least, and goes beyond a limit by at most: a box with its triangles.
  static constexpr std::uint64_t patch_work =
      2 * SurfacePrices::query + SurfacePrices::box + (most_in_patch + 1) * SurfacePrices::triangle;

 private:
  /// Places in node_: its own, those that a patch before has too, in this order.
  struct Nodes {
    std::uint32_t begin, own_end, end;
  };

  [[nodiscard]] static std::uint32_t patch_count(const SurfaceParts& parts) noexcept;
  [[nodiscard]] static std::size_t bytes_of(const SurfaceParts& parts) noexcept;
  void carve(Arena& arena, const SurfaceParts& parts) noexcept;
  void list_nodes(bool* is_owned) noexcept;
  void list_surroundings() noexcept;
  [[nodiscard]] TriangleBox box_of(const Nodes& nodes) const noexcept;

  const SurfaceParts* parts_ = nullptr;
  const Vec4* displacement_ = nullptr;
  double extent_ = 0;                    ///< m, from the origin, as a sum over x, y and z
  std::uint32_t first_patch_ = 0;        ///< among the boxes
  std::uint32_t most_around_ = 0;        ///< triangles around a node
  TriangleBox* boxes_ = nullptr;         ///< [box_count()]
  Nodes* nodes_ = nullptr;               ///< [patches]
  std::uint32_t* node_ = nullptr;        ///< [at most 3 * triangles]
  std::uint32_t* around_end_ = nullptr;  ///< [nodes] where in around_ those of a node end
  std::uint32_t* around_ = nullptr;      ///< [3 * triangles] by node, increasing
};

struct DeformedSurface::Created {
  Surface::Error error = Surface::Error::none;
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  DeformedSurface surface;
  explicit operator bool() const noexcept { return error == Surface::Error::none; }
};

template <class Enters, class Look>
void DeformedSurface::visit(Enters enters, Look look) const noexcept {
  std::uint32_t waiting[32];
  std::uint32_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t box = waiting[--count];
    if (!enters(boxes_[box])) continue;
    if (box >= first_patch_) {
      look(box);
    } else {
      waiting[count++] = 2 * box + 2;
      waiting[count++] = 2 * box + 1;
    }
  }
}

template <class Beyond, class Look>
void DeformedSurface::visit_nearer_first(Beyond beyond, Look look) const noexcept {
  std::uint32_t waiting[32];
  std::uint32_t count = 0;
  if (beyond(boxes_[0]) <= 0) waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t box = waiting[--count];
    if (box >= first_patch_) {
      look(box);
      continue;
    }
    const double left = beyond(boxes_[2 * box + 1]), right = beyond(boxes_[2 * box + 2]);
    const std::uint32_t nearer = left <= right ? 2 * box + 1 : 2 * box + 2;
    if (!((left <= right ? right : left) > 0)) waiting[count++] = 4 * box + 3 - nearer;
    if (!((left <= right ? left : right) > 0)) waiting[count++] = nearer;
  }
}

template <class Visit>
void DeformedSurface::visit_around(const TrianglePoint& point, Visit visit) const noexcept {
  const auto& corner = triangle(point.triangle).node;
  const auto has = [&](std::uint32_t t, std::uint32_t node) {
    const auto& [a, b, c] = triangle(t).node;
    return a == node || b == node || c == node;
  };
  const int first = point.weight[0] > 0 ? 0 : point.weight[1] > 0 ? 1 : 2;
  const std::uint32_t node = corner[first];
  for (std::uint32_t i = node == 0 ? 0 : around_end_[node - 1]; i < around_end_[node]; ++i) {
    bool lies_in = true;
    for (int k = 0; k < 3; ++k) lies_in = lies_in && (!(point.weight[k] > 0) || has(around_[i], corner[k]));
    if (lies_in) visit(around_[i]);
  }
}

}  // namespace greenloop
