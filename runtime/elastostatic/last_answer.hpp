#pragma once

#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// The last answer of a body: which nodes were held, with what force, and which waited to be.
class LastAnswer {
 public:
  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts, std::uint64_t nodes) noexcept;

  /// Contacts that were held.
  [[nodiscard]] std::uint32_t contacts() const noexcept { return contacts_; }

  /// Place of a node among them; layout::none if it was not held. For the loop; work: constant.
  [[nodiscard]] std::uint32_t place(std::uint32_t node) const noexcept {
    const std::uint32_t place = place_[node];
    return place < contacts_ && node_[place] == node ? place : layout::none;
  }

  /// [3] of a place, N.
  [[nodiscard]] const float* force(std::uint32_t place) const noexcept { return force_ + std::size_t{3} * place; }

  /// Steps in a row that a place has waited.
  [[nodiscard]] std::uint32_t waited(std::uint32_t place) const noexcept { return waited_[place]; }

  /// Whether any has.
  [[nodiscard]] bool waiting() const noexcept { return waiting_; }

  /// Whether most contacts were held: three quarters, of the larger set. For the loop; work: a unit a contact.
  [[nodiscard]] bool persists(std::span<const Constraint> contacts) const noexcept;

  /// Whether all were, and no other. For the loop; work: a unit a contact.
  [[nodiscard]] bool stays(std::span<const Constraint> contacts) const noexcept;

  /// Takes the answer of a step. force: [3 * contacts]. For the loop; work: 8 units a contact.
  void remember(std::span<const Constraint> contacts, const ContactSet& set, const float* force) noexcept;

  /// What was reported of it as StepReport::error.
  [[nodiscard]] float error() const noexcept { return error_; }
  void set_error(float error) noexcept { error_ = error; }

  /// Nothing is held.
  void release() noexcept { contacts_ = 0; }

 private:
  [[nodiscard]] std::size_t common(std::span<const Constraint> contacts) const noexcept;

  std::uint32_t contacts_ = 0;
  bool waiting_ = false;
  float error_ = 0;
  std::uint32_t* node_ = nullptr;         ///< [contacts]
  std::uint32_t* place_ = nullptr;        ///< [nodes] in node_, of those that are there
  std::uint16_t* waited_ = nullptr;       ///< [contacts]
  std::uint16_t* next_waited_ = nullptr;  ///< [contacts] scratch
  float* force_ = nullptr;                ///< [3 * contacts]
};

}  // namespace greenloop
