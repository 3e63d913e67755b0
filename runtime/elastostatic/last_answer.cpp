#include "runtime/elastostatic/last_answer.hpp"

#include <cstring>
#include <utility>

namespace greenloop {

void LastAnswer::carve(Arena& arena, std::uint32_t contacts, std::uint64_t nodes) noexcept {
  node_ = arena.take<std::uint32_t>(contacts);
  place_ = arena.take_zeroed<std::uint32_t>(nodes);
  waited_ = arena.take<std::uint16_t>(contacts);
  next_waited_ = arena.take<std::uint16_t>(contacts);
  force_ = arena.take<float>(std::uint64_t{3} * contacts);
}

std::size_t LastAnswer::common(std::span<const Constraint> contacts) const noexcept {
  std::size_t common = 0;
  for (const Constraint& contact : contacts) {
    common += place(contact.node) != layout::none ? 1 : 0;
  }
  return common;
}

bool LastAnswer::stays(std::span<const Constraint> contacts) const noexcept {
  return contacts.size() == contacts_ && common(contacts) == contacts_;
}

bool LastAnswer::persists(std::span<const Constraint> contacts) const noexcept {
  const std::size_t common = this->common(contacts);
  const std::size_t larger = contacts.size() > contacts_ ? contacts.size() : contacts_;
  return 4 * common >= 3 * larger && common > 0;
}

void LastAnswer::remember(std::span<const Constraint> contacts, const ContactSet& set, const float* force) noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t place = this->place(contacts[i].node);
    const std::uint32_t before = place == layout::none ? 0 : waited_[place];
    next_waited_[i] = static_cast<std::uint16_t>(set.holds(i) ? 0 : before + 1);
  }
  std::swap(waited_, next_waited_);
  waiting_ = set.waiting > 0;
  contacts_ = static_cast<std::uint32_t>(contacts.size());
  for (std::uint32_t i = 0; i < contacts_; ++i) {
    node_[i] = contacts[i].node;
    place_[contacts[i].node] = i;
  }
  std::memcpy(force_, force, sizeof(float) * 3 * contacts_);
}

}  // namespace greenloop
