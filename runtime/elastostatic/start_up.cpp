// What a body is made of, before the loop.
#include <cstddef>
#include <cstdint>

#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/requirement.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

Elastostatic::Intent Elastostatic::intended(const Model& model) noexcept {
  if (model.problem() != layout::Problem::elastostatic) {
    return {};
  }
  const layout::Info& info = *model.view().info;
  return {.limits = {.max_contacts = info.max_contacts, .model_loads = info.loads > 0},
          .budget = {info.step_work},
          .rate = info.rate,
          .share = info.share > 0 ? info.share : 1};
}

Elastostatic::Requirement Elastostatic::required(const Model& model, const Elastostatic::Limits& limits) noexcept {
  BodySizes sizes;
  Elastostatic::Requirement requirement;
  measure_body(model.view(), limits, sizes, requirement);
  if (!sizes.supported) {
    return {};
  }
  Arena counting;
  place_body(counting, model.view(), sizes);
  requirement.bytes = counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
  return requirement;
}

Elastostatic::Created Elastostatic::create(const Model& model, const Elastostatic::Limits& limits,
                                           std::span<std::byte> memory) noexcept {
  const ModelView& view = model.view();
  Created created;
  created.available = memory.size();
  BodySizes sizes;
  Elastostatic::Requirement requirement;
  measure_body(view, limits, sizes, requirement);
  if (!sizes.supported) {
    created.error = in_range(limits) ? CreateError::unsupported_model : CreateError::bad_limits;
    return created;
  }
  Arena counting;
  place_body(counting, view, sizes);
  if (counting.bytes() > memory.size()) {
    created.requested = counting.bytes() <= SIZE_MAX ? static_cast<std::size_t>(counting.bytes()) : 0;
    created.error = CreateError::arena_too_small;
    created.missing = created.requested > memory.size() ? created.requested - memory.size() : 0;
    return created;
  }
  created.requested = static_cast<std::size_t>(counting.bytes());
  if (reinterpret_cast<std::uintptr_t>(memory.data()) % requirement.alignment != 0) {
    created.error = CreateError::arena_misaligned;
    return created;
  }
  Arena arena(memory.data());
  created.body.body_ = place_body(arena, view, sizes);
  if (created.body.body_ == nullptr) {
    created.error = CreateError::unsupported_model;
    return created;
  }
  created.body.body_->least_work = requirement.least_work;
  return created;
}

}  // namespace greenloop
