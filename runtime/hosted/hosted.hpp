#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/constraint.hpp"
#include "runtime/loop.hpp"
#include "runtime/model.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

inline constexpr std::uint64_t any_budget = std::uint64_t{1} << 60;

/// A body of a solver in memory of its own, with the buffers of its answer: for programs and tests on a machine with a
/// heap. Solver: a class with the verbs of runtime/loop.hpp that answers constraints with forces and displacements.
template <class Solver>
class Hosted {
 public:
  using Limits = typename Solver::Limits;
  using Requirement = typename Solver::Requirement;
  using StepReport = typename Solver::StepReport;

  /// `model` must outlive it. Throws std::runtime_error if it is refused, or the limits are.
  Hosted(const Model& model, const Limits& limits)
      : model_(&model),
        limits_(limits),
        requirement_(Solver::required(model, limits)),
        arena_(requirement_.bytes),
        field_(std::size_t{16} * model.node_count()),
        force_(3 * (most_constraints(limits) + std::size_t{more_than_allowed})) {
    renew();
  }

  /// A new body in the same memory, and buffers of zeros.
  void renew() {
    const auto created = Solver::create(*model_, limits_, {arena_.data(), arena_.size()});
    if (!created) {
      throw std::runtime_error("no body for this model and " + std::to_string(limits_.max_contacts) +
                               " contacts (error " + std::to_string(static_cast<int>(created.error)) + ")");
    }
    body_ = created.body;
    std::fill(force_.begin(), force_.end(), 0.0F);
    const std::span<float> all = field();
    std::fill(all.begin(), all.end(), 0.0F);
  }

  /// One step within `work` units, with the field of all nodes if it is wanted. Uses the heap only for more than 16
  /// constraints beyond the limits.
  StepReport step(std::span<const Constraint> constraints, std::uint64_t work = any_budget, bool with_field = true) {
    return body_.step(constraints, {work}, response(constraints.size(), with_field));
  }

  /// The same under loads of the solver's.
  template <class Loads = typename Solver::Loads>
  StepReport step(std::span<const Constraint> constraints, const Loads& loads, std::uint64_t work, bool with_field) {
    return body_.step(constraints, loads, {work}, response(constraints.size(), with_field));
  }

  [[nodiscard]] const Limits& limits() const { return limits_; }
  [[nodiscard]] const Requirement& requirement() const { return requirement_; }
  [[nodiscard]] Solver& body() { return body_; }

  /// [3 * constraints of the last step] N, as of the last one that was answered.
  [[nodiscard]] std::span<const float> force() const { return {force_.data(), forces_}; }
  /// The whole buffer that those are at the front of.
  [[nodiscard]] std::span<const float> force_buffer() const { return force_; }
  /// [4 * nodes] m, as of the last step that was answered with a field.
  [[nodiscard]] std::span<float> field() { return {reinterpret_cast<float*>(field_.data()), field_.size() / 4}; }
  [[nodiscard]] std::span<const float> field() const {
    return {reinterpret_cast<const float*>(field_.data()), field_.size() / 4};
  }

 private:
  static constexpr std::size_t more_than_allowed = 16;

  static std::size_t most_constraints(const Limits& limits) {
    if constexpr (requires { limits.max_forces; }) {
      return std::size_t{limits.max_contacts} + limits.max_forces;
    } else {
      return limits.max_contacts;
    }
  }

  typename Solver::Response response(std::size_t constraints, bool with_field) {
    forces_ = 3 * constraints;
    if (forces_ > force_.size()) force_.resize(forces_);
    return {as_vec3(std::span(force_).first(forces_)), as_vec4(with_field ? field() : std::span<float>())};
  }

  const Model* model_;
  Limits limits_;
  Requirement requirement_;
  AlignedBytes arena_, field_;
  std::vector<float> force_;
  std::size_t forces_ = 0;
  Solver body_;
};

}  // namespace greenloop
