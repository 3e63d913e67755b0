#pragma once

#include <cstddef>
#include <span>

#include "formats/verify.hpp"
#include "formats/view.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// A precomputed body, read in place. Immutable: any number of bodies and threads may share one.
/// The caller's bytes must outlive it and stay unchanged; they must be 64-byte aligned.
class Model {
 public:
  struct Opened;

  /// Verifies every field once. Start-up only; work linear in the bytes; no heap, no exception.
  [[nodiscard]] static Opened open(std::span<const std::byte> bytes) noexcept;

  [[nodiscard]] const ModelView& view() const noexcept { return view_; }
  /// What the model answers: a solver takes models of its own problem.
  [[nodiscard]] layout::Problem problem() const noexcept { return view_.problem; }
  [[nodiscard]] std::uint32_t node_count() const noexcept { return view_.node_count; }
  /// Nodes of mesh levels 0..level, which come first; level below level_count().
  [[nodiscard]] std::uint32_t node_count(std::uint32_t level) const noexcept;
  /// Whether a node may be a contact; false for one that the model does not have. Work: a unit per level.
  [[nodiscard]] bool is_touchable(std::uint32_t node) const noexcept;
  /// Where a node is at rest, m; node below node_count(). Work: a unit per level.
  [[nodiscard]] Vec3 position(std::uint32_t node) const noexcept;
  [[nodiscard]] std::uint32_t level_count() const noexcept { return view_.levels; }

 private:
  ModelView view_;
};

struct Model::Opened {
  VerifyResult result;  ///< says which field is wrong, if any
  Model model;          ///< usable only if result.ok()
  explicit operator bool() const noexcept { return result.ok(); }
};

}  // namespace greenloop
