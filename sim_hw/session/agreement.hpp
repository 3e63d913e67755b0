#pragma once

#include <cstdint>

#include "runtime/contact_body.hpp"
#include "sim_hw/session/session.hpp"

namespace greenloop {

/// What a run asks of its body.
struct Agreement {
  ContactBody::Limits limits;
  Budget budget;
  std::uint64_t least_work = 0;
};

/// Room for the contacts of the scene, and for more where the budget holds them. Throws std::runtime_error if the
/// budget is below Requirement::least_work.
[[nodiscard]] Agreement agree(const SessionOptions& options, const Model& model);

}  // namespace greenloop
