#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/touching_script.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/surface.hpp"

namespace greenloop {

/// What the tools of a script do: see docs/budgets.md, "Checking it on your model".
enum class ToolScriptKind : std::uint8_t {
  wander,    ///< TouchingScript: they press, drag, jump and are spoilt, with budgets from refused to plenty
  press,     ///< they press and drag, without friction, with some, with much
  teleport,  ///< they are somewhere else in every step
  spin,      ///< pressed in, they turn by any angle in every step
  inside,    ///< they move in the body's inside, and in and out of it
  outside,   ///< far away, and beside the body
  graze,     ///< they touch by a rounding error, or just not
  edges,     ///< on corners, edges and triangles of the surface, with points, edges and faces of their own
  fixed,     ///< on what cannot move
  crowd,     ///< all on the same place, of all shapes
  starve,    ///< as `press`, with budgets from refused to plenty
  garbage,   ///< poses, shapes, frictions and numbers of tools that are none
};
inline constexpr std::array<const char*, 12> tool_script_names = {"wander", "press",   "teleport", "spin",
                                                                  "inside", "outside", "graze",    "edges",
                                                                  "fixed",  "crowd",   "starve",   "garbage"};
[[nodiscard]] constexpr const char* name(ToolScriptKind kind) {
  return tool_script_names[static_cast<std::size_t>(kind)];
}

/// Adversarial tools about a body, by a seed: shapes of all kinds as large as its triangles or as itself, on places of
/// its surface at rest. Of a step at most most_tools tools, or one more to be refused.
class ToolScript {
 public:
  static constexpr std::uint32_t most_tools = TouchingScript::most_tools;
  using Cycle = TouchingScript::Cycle;

  /// need: of the body that is to be stepped, of max_tools most_tools and max_points 8 or more. Throws
  /// std::runtime_error if the model has no surface or no node that can be touched.
  ToolScript(const Model& model, const ContactBody::Requirement& need, ToolScriptKind kind, std::uint64_t seed);

  /// The next cycle of a body.
  [[nodiscard]] Cycle next(ContactBody& body);

 private:
  struct Place {
    Double3 position, normal;  ///< m, at rest; unit, outwards
  };

  void read_surface(const Model& model);
  [[nodiscard]] Cycle cycle_of(ContactBody& body);
  void put(std::uint32_t tool, const Shape& shape, const Double3& position, double friction);
  void press(std::uint32_t tool, std::span<const double> frictions);
  void teleport(std::uint32_t tool);
  void spin(std::uint32_t tool);
  void go_inside(std::uint32_t tool);
  void go_outside(std::uint32_t tool);
  void graze(std::uint32_t tool);
  void meet_edges(std::uint32_t tool);
  void touch_fixed(std::uint32_t tool);
  void crowd(std::uint32_t tool);
  [[nodiscard]] bool spoil(std::uint32_t tool);

  [[nodiscard]] Shape any_shape(double size);
  [[nodiscard]] const Place& any(const std::vector<Place>& places) { return places[random_() % places.size()]; }
  [[nodiscard]] const Place& stay_at(std::uint32_t tool, const std::vector<Place>& places);
  [[nodiscard]] double between(double low, double high);
  [[nodiscard]] Double3 vector(double most);
  void turn(Pose& pose);

  ToolScriptKind kind_;
  ContactBody::Requirement need_;
  std::optional<TouchingScript> wander_;
  std::mt19937_64 random_;
  std::uint64_t cycle_ = 0;
  std::vector<Place> touchable_, fixed_;  ///< nodes
  std::vector<Place> between_;            ///< middles of edges, triangles
  double size_ = 0, edge_ = 0;            ///< m, of the body's shortest side; mean, of its triangles
  ContactBody::ToolInput tool_[most_tools + 1];
  std::size_t at_[most_tools + 1] = {};  ///< places that tools stay at
  Shape shape_[most_tools + 1];
  AlignedBytes solid_memory_;
  ConvexPolyhedron solid_;
};

}  // namespace greenloop
