#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "rt_tests/harness/script_bounds.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop {

/// Random tools about a body, the same on every target: made by integers, sums, products and square roots alone,
/// without heap. Tools of all shapes wander around it and through it, press and drag; some jump, are forgotten, put
/// down in other numbers or with another shape; poses and frictions are garbage now and then; budgets go from refused
/// to plenty.
class TouchingScript {
 public:
  static constexpr std::uint32_t most_tools = 3;
  static constexpr std::uint32_t corners = 6;  ///< of the polyhedron, an octahedron
  static constexpr std::uint32_t faces = 8;

  /// What the script needs of a body.
  [[nodiscard]] static constexpr ContactBody::Limits limits(std::uint32_t contacts, std::uint32_t iterations) noexcept {
    ContactBody::Limits same;
    same.elastostatic = {.max_contacts = contacts, .cached_factors = 2, .iterations = iterations};
    same.max_tools = most_tools;
    return same;
  }

  struct Cycle {
    std::span<const ContactBody::ToolInput> tools;  ///< valid until the next cycle; at most most_tools + 1
    Budget budget;
    bool is_sound = true;  ///< nothing is wrong with numbers of tools, poses, shapes and frictions
  };

  /// The tools wander around the middle of the model. need: of the body that is to be stepped.
  TouchingScript(const Model& model, const ContactBody::Requirement& need, std::uint64_t seed) noexcept;

  /// The next cycle of a body.
  [[nodiscard]] Cycle next(ContactBody& body) noexcept;

 private:
  struct Path {
    Double3 way;  ///< unit, from the middle
    double distance = 0, speed = 0;
    double quaternion[4] = {1, 0, 0, 0};
    std::uint32_t shape = 0;
    double friction = 0;
  };

  [[nodiscard]] Shape shape_of(std::uint32_t number) const noexcept;
  void put_down(Path& path) noexcept;
  void wander(Path& path) noexcept;
  void turn(Path& path, double much) noexcept;
  [[nodiscard]] bool spoil(ContactBody::ToolInput& tool) noexcept;
  [[nodiscard]] Budget draw_budget() noexcept;
  [[nodiscard]] std::uint64_t random() noexcept;
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) noexcept;
  [[nodiscard]] double uniform() noexcept;  ///< -1..1

  ContactBody::Requirement need_;
  std::uint64_t state_;
  Double3 middle_;
  double reach_ = 0;
  Path path_[most_tools + 1];
  ContactBody::ToolInput tool_[most_tools + 1];
  alignas(64) std::byte solid_memory_[2048];
  ConvexPolyhedron solid_;
};

}  // namespace greenloop
