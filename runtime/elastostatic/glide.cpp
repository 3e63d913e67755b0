#include "runtime/elastostatic/glide.hpp"

#include <cmath>
#include <cstring>

namespace greenloop {

void Glide::carve(Arena& arena, std::uint32_t contacts, std::uint64_t nodes, std::uint32_t cycles) noexcept {
  cycles_ = cycles;
  const std::uint64_t components = std::uint64_t{3} * contacts;
  node_ = arena.take<std::uint32_t>(contacts);
  place_ = arena.take_zeroed<std::uint32_t>(nodes);
  level_ = arena.take<std::uint8_t>(contacts);
  next_level_ = arena.take<std::uint8_t>(contacts);
  force_ = arena.take<float>(components);
  difference_ = arena.take<float>(components);
  next_difference_ = arena.take<float>(components);
  older_force_ = arena.take<float>(components);
}

std::uint32_t Glide::last_place(std::uint32_t node) const noexcept {
  const std::uint32_t place = place_[node];
  return place < contacts_ && node_[place] == node ? place : layout::none;
}

const float* Glide::last_force(std::uint32_t node) const noexcept {
  const std::uint32_t place = last_place(node);
  return place == layout::none ? nullptr : force_ + std::size_t{3} * place;
}

std::size_t Glide::common(std::span<const Contact> contacts) const noexcept {
  std::size_t common = 0;
  for (const Contact& contact : contacts) {
    common += last_place(contact.node) != layout::none ? 1 : 0;
  }
  return common;
}

bool Glide::stays(std::span<const Contact> contacts) const noexcept {
  return contacts.size() == contacts_ && common(contacts) == contacts_;
}

bool Glide::persists(std::span<const Contact> contacts) const noexcept {
  const std::size_t common = this->common(contacts);
  const std::size_t larger = contacts.size() > contacts_ ? contacts.size() : contacts_;
  return 4 * common >= 3 * larger && common > 0;
}

void Glide::turn_back() noexcept {
  const std::uint32_t from = from_;
  from_ = to_;
  to_ = from;
  left_ = cycles_ - left_ - 1;
  for (std::uint32_t i = 0; i < 3 * contacts_; ++i) {
    difference_[i] = -difference_[i];
  }
}

bool Glide::moves(std::span<const Contact> contacts) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t last = last_place(contacts[i].node);
    if (last != layout::none && level_[last] != next_level_[i]) {
      return true;
    }
  }
  return false;
}

void Glide::advance(std::span<const Contact> contacts, const ContactSet& set) noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    next_level_[i] = static_cast<std::uint8_t>(column_level(set.column[set.place[i]]));
  }
  const std::uint32_t level = set.coarsest() == set.finest() ? set.coarsest() : mixed;
  const bool persist = persists(contacts);
  const bool changes = persist && (level != to_ || moves(contacts));
  const bool returns = changes && left_ > 0 && !kept_ && level == from_ && level != mixed;
  fresh_ = changes && !returns;
  moving_ = persist && (changes || left_ > 0);
  if (fresh_) {
    kept_ = left_ > 0;  // in the middle of a glide the last answer is of no single level
    from_ = to_;
    to_ = level;
    left_ = cycles_ - 1;
  } else if (returns) {
    turn_back();
  } else if (moving_) {
    --left_;
  } else {
    to_ = level;
    left_ = 0;
  }
}

GlideReport Glide::blend(std::span<const Contact> contacts, const float* older, float* force) noexcept {
  if (!moving_) {
    kept_weight_ = 0;
    remember(contacts, force);
    return {};
  }
  kept_ = older == nullptr;
  const auto cycles = static_cast<float>(cycles_);
  const float weight = static_cast<float>(left_) / cycles;
  float largest = 0;
  double along = 0;  // displacements times this difference, and the one before; neither overflows
  double before = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t last = last_place(contacts[i].node);
    for (std::size_t r = 0; r < 3; ++r) {
      float& newer = force[3 * i + r];
      const std::size_t k = std::size_t{3} * last + r;
      const float was = last == layout::none ? 0 : difference_[k];
      const float known = last == layout::none ? 0 : fresh_ ? force_[k] - newer : was;
      const float difference = older != nullptr ? older[3 * i + r] - newer : known;
      const float displacement = without_denormals(contacts[i].displacement[r]);
      const float size = std::fabs(difference);
      largest = size > largest ? size : largest;
      along += double{difference} * displacement;
      before += double{was} * displacement;
      next_difference_[3 * i + r] = difference;
      newer += weight * difference;
    }
  }
  // a kept difference is a force that does not follow the hand: it stores all of its product, not half
  const float kept_weight = kept_ ? weight : 0;
  const double work = (kept_weight * along - kept_weight_ * before - along / cycles) / 2;
  kept_weight_ = kept_weight;
  float* const differences = next_difference_;
  next_difference_ = difference_;
  difference_ = differences;
  remember(contacts, force);
  return {1 - weight, largest, work};
}

void Glide::remember(std::span<const Contact> contacts, const float* force) noexcept {
  contacts_ = static_cast<std::uint32_t>(contacts.size());
  for (std::uint32_t i = 0; i < contacts_; ++i) {
    node_[i] = contacts[i].node;
    place_[contacts[i].node] = i;
  }
  std::uint8_t* const levels = next_level_;
  next_level_ = level_;
  level_ = levels;
  std::memcpy(force_, force, sizeof(float) * 3 * contacts_);
}

}  // namespace greenloop
