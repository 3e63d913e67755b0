#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::bench {

/// A body with memory of its own and the buffers of its answer.
class Stepper {
 public:
  Stepper(const Model& model, std::size_t contacts, std::size_t factors)
      : force_(3 * contacts), displacement_(16 * std::size_t{model.node_count()}) {
    const Elastostatic::Limits limits{static_cast<std::uint32_t>(contacts), static_cast<std::uint32_t>(factors)};
    memory_ = AlignedBytes(Elastostatic::required(model, limits).bytes);
    auto created = Elastostatic::create(model, limits, {memory_.data(), memory_.size()});
    if (!created) {
      throw std::runtime_error("a body of " + std::to_string(contacts) + " contacts cannot be made");
    }
    body_ = created.body;
  }

  Elastostatic::StepReport step(const std::vector<Constraint>& set, std::uint64_t work = UINT64_MAX) {
    return body_.step(set, {work}, {{force_.data(), 3 * set.size()}, {displacement(), displacement_.size() / 4}});
  }

  /// The forces alone.
  Elastostatic::StepReport step_forces(const std::vector<Constraint>& set) {
    return body_.step(set, {UINT64_MAX}, {{force_.data(), 3 * set.size()}, {}});
  }

  [[nodiscard]] const std::vector<float>& force() const { return force_; }
  [[nodiscard]] float* displacement() { return reinterpret_cast<float*>(displacement_.data()); }

 private:
  std::vector<float> force_;
  AlignedBytes memory_, displacement_;
  Elastostatic body_;
};

}  // namespace greenloop::bench
