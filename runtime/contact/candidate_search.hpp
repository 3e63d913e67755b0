#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/contact/candidate.hpp"
#include "runtime/contact/deformed_surface.hpp"
#include "runtime/contact/proxy.hpp"
#include "runtime/contact/tool.hpp"
#include "runtime/loop.hpp"

namespace greenloop {

/// Finds what of a deformed surface may touch rigid tools, continuously in the tools' motion: touchable nodes against
/// the shapes, and the shapes' points against the triangles, each on the side from which the tool came. It remembers
/// the tools' last placements and their points' proxies. A tool is known by its place among the tools.
class CandidateSearch {
 public:
  struct Limits {
    std::uint32_t max_tools = 1;       ///< at least 1, at most 254
    std::uint32_t max_points = 8;      ///< of one shape, at most Shape::max_points
    std::uint32_t max_candidates = 1;  ///< of a step, at least 1
    double margin = 1e-3;              ///< m, >= 0: candidates have gaps of no more
    double fine_radius = 0;  ///< m: of a point with a smaller radius around it places in the triangles beside its
                             ///< nearest one are candidates, too
  };
  /// Candidates that a tool's point is at most: the nearest place, and those beside it.
  static constexpr std::uint32_t most_places = 5;

  struct Created;

  struct Found {
    std::span<const Candidate> candidates;  ///< by tool; of each its nodes, increasing, then its points; until the next
    std::uint32_t left_out = 0;             ///< candidates for which there was no room: the deepest were kept
    Candidate deepest_left_out;             ///< of use if there are any
    std::uint32_t unfinished = 0;           ///< tools that were not looked at as a whole, for lack of work
  };

  /// Of no use before `create`.
  CandidateSearch() = default;

  /// Bytes; 0 for bad limits. Constant work.
  [[nodiscard]] static std::size_t required(const Limits& limits) noexcept;
  /// memory: 64-byte aligned; must outlive it. Start-up; linear in the limits.
  [[nodiscard]] static Created create(const Limits& limits, std::span<std::byte> memory) noexcept;

  /// The candidates of a step. tools: those beyond max_tools are left alone, and so are faulty ones, whose history
  /// stays as it was. A tool without history, or with another number of points than in the last step, is placed where
  /// it is. Of equally deep candidates that of the earlier tool goes first, of its nodes before its points, the one of
  /// the smaller number. For the loop; work: what was looked at is added to `work`, at most find_work(); the boxes,
  /// nodes and triangles that the tools come near, as a rule. It never goes beyond `most`, at least least_find_work
  /// more than `work`: a tool's points come first, then nodes, nearer parts of the surface before others, each with a
  /// share of what is left. Points for which it does not suffice stay as they are (Proxy::move); nodes are left out.
  [[nodiscard]] Found find(const DeformedSurface& surface, std::span<const Tool> tools, std::uint64_t& work,
                           std::uint64_t most = all_work) noexcept;
  [[nodiscard]] std::uint64_t find_work(const DeformedSurface& surface, std::span<const Tool> tools) const noexcept;

  /// Work units that `find` has to be given, for any tools within the limits. Constant work.
  [[nodiscard]] static std::uint64_t least_find_work(const Limits& limits, const SurfaceSizes& surface) noexcept;

  /// What suffices for as many candidates as there is room for, of tools that each touch one part of a body without
  /// leaping, and that are no polyhedra of many faces. Constant work.
  [[nodiscard]] static std::uint64_t usual_find_work(const Limits& limits, const SurfaceSizes& surface) noexcept;

  /// How far its force holds each node out of the tools, m, [nodes], >= 0; it counts where there is no room for all:
  /// what is pushed is no less deep than what is not. Read by every `find` from now on; empty: 0.
  void heed(std::span<const float> held_out) noexcept { held_out_ = held_out; }

  /// Of the last step. For the loop.
  [[nodiscard]] ToolFault fault(std::uint32_t tool) const noexcept { return tool_[tool].fault; }
  /// Of one of the tool's points, as of the last step in which the tool had no fault.
  [[nodiscard]] const Proxy& proxy(std::uint32_t tool, std::uint32_t point) const noexcept {
    return proxy_[std::size_t{limits_.max_points} * tool + point];
  }

  /// The tool is somewhere else without having been between: it is placed anew in the next step.
  void forget(std::uint32_t tool) noexcept { tool_[tool].has_history = false; }

 private:
  struct ToolState {
    bool has_history = false;
    ToolFault fault = ToolFault::none;
    std::uint32_t points = 0;
    Placement last;
  };
  struct Step {
    const DeformedSurface& surface;
    const Shape& shape;
    Placement last, present;
    std::uint32_t tool;
    std::uint64_t& work;
    std::uint64_t most;
  };

  void carve(Arena& arena) noexcept;
  void look(const DeformedSurface& surface, const Tool& tool, std::uint32_t number, std::uint64_t& work,
            std::uint64_t most) noexcept;
  [[nodiscard]] bool look_at_nodes(const Step& step) noexcept;
  void look_at_node(const Step& step, std::uint32_t node) noexcept;
  [[nodiscard]] bool look_at_points(const Step& step) noexcept;
  void take_point(const Step& step, std::uint32_t point, const Proxy& proxy) noexcept;
  void take_beside(const Step& step, const Double3& centre, const Proxy& proxy) noexcept;
  void take(Candidate candidate) noexcept;

  Limits limits_;
  ToolState* tool_ = nullptr;       ///< [max_tools]
  Proxy* proxy_ = nullptr;          ///< [max_tools * max_points]
  Candidate* candidate_ = nullptr;  ///< [max_candidates + 1]
  Candidate* listed_ = nullptr;     ///< [max_candidates]
  std::uint32_t* order_ = nullptr;  ///< [max_candidates + 1] of candidate_
  std::uint32_t* spare_ = nullptr;  ///< as many
  std::span<const float> held_out_;
  std::uint32_t count_ = 0;
  Found found_;
};

struct CandidateSearch::Created : Creation {
  CandidateSearch search;
};

}  // namespace greenloop
