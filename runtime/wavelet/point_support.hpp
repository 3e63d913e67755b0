#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

/// The nodes of a coarser level that a node's value is interpolated from, and that a force on it is shared among: the
/// corners of a triangle; with Butterfly wavelets the nodes within about three edges. Block predictions are from nodes
/// near in space, wherever they are on the mesh: if those are within r edges of their level, the support is within 2 r,
/// since every finer level adds half of what the next coarser one does. That is about 15 r^2 nodes on each sheet of the
/// surface that is so near; the six nearest nodes of a regular mesh are within 1.4 edges.
class PointSupport {
 public:
  static constexpr std::uint32_t most =
      192;  ///< Butterfly: vertices of 30 edges and more; blocks: r of 2.5 on two sheets

  explicit PointSupport(std::uint32_t limit) : limit_(limit) { clear(); }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] std::uint32_t node(std::uint32_t i) const { return node_[i]; }

  /// Adds a node unless it is there. False if there were `limit` others. Work: constant on average.
  bool add(std::uint32_t node);
  void clear();

 private:
  static constexpr std::uint32_t slots = 256;

  std::uint32_t limit_;
  std::uint32_t count_ = 0;
  std::uint32_t node_[most];
  std::uint32_t slot_[slots];  // by hash, open addressing; layout::none: empty
};

/// Nodes of a support that a model's wavelets may have: 3 or PointSupport::most.
[[nodiscard]] std::uint32_t most_support(const ModelView& view) noexcept;

/// Fills `coarse` with the domain nodes that predict the nodes of M(level) in `support`, and the other nodes in it.
/// False if that are more than its limit: no subdivided triangulation does that with numbers as weights.
[[nodiscard]] bool coarsen(const ModelView& view, std::uint32_t level, const PointSupport& support,
                           PointSupport& coarse) noexcept;

/// Most coefficients that a force on one node of K(c) reaches.
struct ReachBound {
  bool bounded = false;  ///< no node of K(c) hangs on more than most_support nodes of a coarser level
  std::uint32_t coefficients[layout::max_levels] = {};  ///< of each level
};

/// lifting: of every level. Start-up; linear in domain nodes times levels.
[[nodiscard]] ReachBound bound_reach(const ModelView& view, std::uint32_t c, const LiftingCounts* lifting) noexcept;

}  // namespace greenloop
