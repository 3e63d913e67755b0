#include "sim_hw/session/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop {
namespace {

/// Units: those named, else what the scene gives the elastic body and what finding contacts takes besides, else the
/// worst case.
std::uint64_t whole_budget(const SessionOptions& options, const Model& model, const ContactBody::Requirement& need) {
  if (options.budget != 0) return options.budget;
  const std::uint64_t of_scene = Elastostatic::intended(model).budget.work;
  return of_scene != 0 ? of_scene + need.touching_work : need.worst_work;
}

/// Whether a budget is what the scene gives, which was meant for a body without tools and their laws of contact.
bool is_of_scene(const SessionOptions& options, const Model& model) {
  return options.budget == 0 && Elastostatic::intended(model).budget.work != 0;
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
    std::uint64_t whole = whole_budget(options, model, need);
    if (contacts == intended && is_of_scene(options, model)) whole = std::max(whole, need.least_work);
    agreement.budget.work = static_cast<std::uint64_t>(std::floor(static_cast<double>(whole) * options.starve));
    if (agreement.budget.work >= need.least_work) return agreement;
    if (contacts == intended) break;
  }
  throw std::runtime_error("budget: " + std::to_string(agreement.budget.work) +
                           " units per cycle cannot hold even the coarsest answer; the least budget of this model is " +
                           std::to_string(agreement.least_work));
}

}  // namespace greenloop
