#include "sim_hw/session/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop {
namespace {

/// Units; 0: none is asked for.
std::uint64_t budget_of(const SessionOptions& options, const Model& model, std::uint64_t touching_work) {
  const std::uint64_t intended = Elastostatic::intended(model).budget.work;
  // the scene's work is the elastic body's; a budget that is named is that of all
  const std::uint64_t of_scene = intended != 0 ? intended + touching_work : 0;
  const std::uint64_t whole = options.budget != 0 ? options.budget : of_scene;
  return static_cast<std::uint64_t>(std::floor(static_cast<double>(whole) * options.starve));
}

/// Room for the contacts of the scene, and, if there is budget for them, for more: what lies under a tool without being
/// pushed takes some, too.
ContactBody::Limits limits_of(const Model& model, std::uint32_t contacts) {
  ContactBody::Limits limits;
  limits.elastostatic = Elastostatic::intended(model).limits;
  limits.elastostatic.max_contacts = contacts;
  limits.elastostatic.iterations = 64;
  limits.elastostatic.model_loads = true;
  limits.max_tools = max_tools;
  limits.max_points = 1;  // of a ball
  return limits;
}

}  // namespace

Agreement agree(const SessionOptions& options, const Model& model) {
  constexpr std::uint32_t usual = 64;
  const std::uint32_t intended = std::min(Elastostatic::intended(model).limits.max_contacts, LoopCommand::max_contacts);
  Agreement agreement;
  for (std::uint32_t contacts = std::max(intended, usual);; contacts = std::max(contacts / 2, intended)) {
    agreement.limits = limits_of(model, contacts);
    const auto need = ContactBody::required(model, agreement.limits);
    agreement.least_work = need.least_work;
    const std::uint64_t asked = budget_of(options, model, need.touching_work);
    agreement.budget.work =
        asked != 0 ? asked
                   : static_cast<std::uint64_t>(std::floor(static_cast<double>(need.worst_work) * options.starve));
    if (agreement.budget.work >= need.least_work) return agreement;
    if (contacts == intended) break;
  }
  throw std::runtime_error("budget: " + std::to_string(agreement.budget.work) +
                           " units per cycle cannot hold even the coarsest answer; the least budget of this model is " +
                           std::to_string(agreement.least_work));
}

}  // namespace greenloop
