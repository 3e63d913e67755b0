#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rt_tests/harness/elastostatic_driver.hpp"

namespace greenloop {

/// An Elastostatic whose steps are given loads beside contacts: every third node is pushed instead of held, the first
/// contact becomes a mask over the first ones, the body is pulled by gravity if the model has it, and is stiffer in
/// turn. Points are asked for after each answer. What was wrong with the contacts stays wrong.
class LoadedElastostatic {
 public:
  using Limits = Elastostatic::Limits;
  using Requirement = Elastostatic::Requirement;
  using Response = Elastostatic::Response;
  using StepReport = Elastostatic::StepReport;
  using Loads = Elastostatic::Loads;
  struct Created;

  static Requirement required(const Model& model, const Limits& limits) noexcept {
    return Elastostatic::required(model, limits);
  }
  static Created create(const Model& model, const Limits& limits, std::span<std::byte> memory);

  StepReport step(std::span<const Constraint> contacts, Budget budget, const Response& response) noexcept {
    if (contacts.size() > constraints_.size()) {
      return body_.step(contacts, budget, response);  // refused, as too many
    }
    const Mask mask = load(contacts);
    Loads loads{.masks = {&mask, 1}, .stiffness = contacts.size() % 3 == 0 ? 2.0F : 1.0F};
    if (has_gravity_) loads.gravity = {0, 0, -9.81F};
    StepReport report = body_.step(std::span(constraints_).first(contacts.size()), loads, budget, response);
    if (answered(report.status) && !ask(contacts)) report.work = ~std::uint64_t{0};  // an overrun
    return report;
  }

 private:
  static constexpr std::size_t most_masked = 4;
  static constexpr float newtons_per_metre = 1e3F;

  static Constraint pushed(const Constraint& contact, std::uint32_t node, Constraint::Kind kind) {
    const float* u = contact.value;
    return {node, {newtons_per_metre * u[0], newtons_per_metre * u[1], newtons_per_metre * u[2]}, kind};
  }

  Mask load(std::span<const Constraint> contacts) noexcept {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Constraint& contact = contacts[i];
      constraints_[i] = contact.node % 3 == 0 ? pushed(contact, contact.node, Constraint::Kind::force) : contact;
    }
    const std::size_t masked = std::min(contacts.size(), most_masked);
    for (std::size_t k = 0; k < masked; ++k) {
      node_[k] = contacts[k].node;
      weight_[k] = 1 / static_cast<float>(masked);
    }
    const auto same = [&](const Constraint& contact) { return contact.node == contacts[0].node; };
    if (std::count_if(contacts.begin(), contacts.end(), same) == 1) {
      constraints_[0] = pushed(contacts[0], 0, Constraint::Kind::pattern);
    }
    return {std::span(node_).first(masked), std::span(weight_).first(masked)};
  }

  // false if it took more than is declared
  bool ask(std::span<const Constraint> contacts) noexcept {
    const std::size_t count = std::min(contacts.size(), most_masked);
    MeshPoint points[most_masked];
    for (std::size_t k = 0; k < count; ++k) points[k] = at_node(contacts[k].node);
    Vec3 moved[most_masked];
    const std::uint64_t work = body_.displacements(std::span(points).first(count), std::span(moved).first(count));
    return work <= selected_work_;
  }

  Elastostatic body_;
  std::vector<Constraint> constraints_;
  std::uint64_t selected_work_ = 0;
  bool has_gravity_ = false;
  std::uint32_t node_[most_masked] = {};
  float weight_[most_masked] = {};
};

struct LoadedElastostatic::Created : Creation {
  LoadedElastostatic body;
};

inline LoadedElastostatic::Created LoadedElastostatic::create(const Model& model, const Limits& limits,
                                                              std::span<std::byte> memory) {
  const Elastostatic::Created created = Elastostatic::create(model, limits, memory);
  Created loaded;
  static_cast<Creation&>(loaded) = created;
  loaded.body.body_ = created.body;
  loaded.body.constraints_.resize(limits.max_contacts);
  loaded.body.selected_work_ = required(model, limits).selected_work;
  loaded.body.has_gravity_ = model.view().has_gravity();
  return loaded;
}

/// The tools on it: see Driver.
struct LoadedDriver : ElastostaticDriver {
  using Solver = LoadedElastostatic;

  static constexpr Elastostatic::Limits limits(std::uint32_t contacts, std::uint32_t sets, const Prices& prices = {}) {
    Elastostatic::Limits limits = ElastostaticDriver::limits(contacts, sets, prices);
    limits.max_forces = contacts + 4;
    limits.model_loads = true;
    limits.max_points = 4;
    return limits;
  }
};
static_assert(Driver<LoadedDriver>);

}  // namespace greenloop
