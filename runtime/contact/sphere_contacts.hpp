#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"
#include "runtime/constraint.hpp"
#include "runtime/contact/node_grid.hpp"
#include "runtime/loop.hpp"

namespace greenloop {

/// A sphere that is pushed into a body.
struct SphereTool {
  Double3 centre;  ///< m
  Double3 axis;    ///< unit vector, where it pushes
};

/// The nodes of an undeformed surface, by file index.
struct SurfaceNodes {
  std::span<const Double3> position;         ///< m
  std::span<const Double3> normal;           ///< outward unit vectors
  std::span<const std::uint32_t> touchable;  ///< the nodes that may be held, increasing
};

/// Which nodes some spheres hold, and where: unilateral contact by an active set that takes one step per cycle.
///
/// A touchable node whose undeformed place lies inside a sphere, on a side of the body that faces it, is held where the
/// tool's axis through the node leaves the sphere. It is added when its place in the last known field lies inside the
/// sphere too (it would penetrate), stays while it is pushed, and is released in the cycle after one in which it had to
/// be pulled. A node inside several spheres belongs to the one that pushes it deepest, of equal ones to the first. Of
/// more than `max_contacts` the deepest are kept; equal depths go by node.
class SphereContacts {
 public:
  struct Limits {
    double radius = 0;               ///< m, > 0, of every tool
    std::uint32_t max_contacts = 0;  ///< per cycle, at least 1
  };
  struct Created;

  static constexpr std::uint32_t max_tools = 254;

  /// Of no use before `create`.
  SphereContacts() = default;

  /// Bytes. Start-up; linear in the touchable nodes. Zero if `create` would refuse for another reason than memory.
  [[nodiscard]] static std::size_t required(const SurfaceNodes& nodes, const Limits& limits) noexcept;

  /// Carves `memory`, 64-byte aligned, with the routine that `required` counts with. What the spans of `nodes` name,
  /// and `memory`, must outlive it; a copy works in the same memory. Start-up; linear in nodes and cells of the grid.
  [[nodiscard]] static Created create(const SurfaceNodes& nodes, const Limits& limits,
                                      std::span<std::byte> memory) noexcept;

  /// The contacts of this cycle by increasing node, valid until the next; none for a tool that is not finite. `tools`:
  /// at most max_tools. `field`: [4 * nodes] m, the displacement last known. For the loop; work: for every tool the
  /// touchable nodes near it, and sorting these.
  [[nodiscard]] std::span<const Constraint> find(std::span<const SphereTool> tools,
                                                 std::span<const float> field) noexcept;

  /// Remembers which of the last contacts were pushed. `force`: [3 * contacts] N, what holds them. For the loop; linear
  /// in the contacts.
  void settle(std::span<const SphereTool> tools, std::span<const float> force) noexcept;

  /// Number of the tool that holds the last contact `i`. For the loop.
  [[nodiscard]] std::uint32_t holder(std::size_t i) const noexcept { return node_[held_[i]].held_by - 1U; }

 private:
  struct Node {
    double depth = 0;          ///< m, along the axis of the tool that holds it to the sphere's surface
    std::uint64_t pushed = 0;  ///< the number of the last `settle` that it was pushed in, and by which tool: push_of
    std::uint8_t held_by = 0;  ///< 1 + the number of the tool; 0: by none
  };

  void carve(Arena& arena) noexcept;
  void gather(const SphereTool& tool, std::uint8_t held_by, std::span<const float> field) noexcept;
  void keep_deepest() noexcept;
  [[nodiscard]] std::uint64_t push_of(std::uint8_t held_by) const noexcept { return settled_ << 8 | held_by; }

  SurfaceNodes nodes_;
  Limits limits_;
  NodeGrid grid_;
  Node* node_ = nullptr;            ///< [nodes]
  std::uint32_t* held_ = nullptr;   ///< [touchable] nodes that some tool holds; no more than max_contacts once found
  std::uint32_t* spare_ = nullptr;  ///< [touchable]
  std::uint32_t count_ = 0;         ///< of those held
  Constraint* contact_ = nullptr;   ///< [max_contacts]
  std::uint64_t settled_ = 0;       ///< how often
};

struct SphereContacts::Created : Creation {
  SphereContacts contacts;
};

}  // namespace greenloop
