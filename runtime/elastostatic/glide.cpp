#include "runtime/elastostatic/glide.hpp"

#include <cmath>
#include <cstring>

namespace greenloop {
namespace {

// whether a contact is held that waited
bool comes_in(std::span<const Constraint> contacts, const ContactSet& set, const LastAnswer& last) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t place = last.place(contacts[i].node);
    if (place != layout::none && last.waited(place) > 0 && set.holds(i)) {
      return true;
    }
  }
  return false;
}

}  // namespace

void Glide::carve(Arena& arena, std::uint32_t contacts, std::uint32_t cycles) noexcept {
  cycles_ = cycles;
  // a glide that begins reads them, times zero
  difference_ = arena.take_zeroed<float>(std::uint64_t{3} * contacts);
  next_difference_ = arena.take_zeroed<float>(std::uint64_t{3} * contacts);
  foreseen_difference_ = arena.take<float>(std::uint64_t{3} * contacts);
}

void Glide::turn_back(std::uint32_t contacts) noexcept {
  const std::uint32_t from = from_;
  from_ = to_;
  to_ = from;
  left_ = span_ - left_ - 1;
  for (std::uint32_t i = 0; i < 3 * contacts; ++i) {
    difference_[i] = -difference_[i];
  }
}

void Glide::advance(std::span<const Constraint> contacts, const ContactSet& set, const LastAnswer& last) noexcept {
  const std::uint32_t level = set.level();
  const bool persist = last.persists(contacts);
  const bool changes = persist && level != to_;
  const bool comes = persist && comes_in(contacts, set, last);
  const bool returns = changes && !comes && left_ > 0 && !kept_ && level == from_;
  fresh_ = comes || (changes && !returns);
  foreseen_ = fresh_ && foreseen_level_ == level;
  foreseen_level_ = layout::none;
  moving_ = persist && (changes || comes || left_ > 0);
  if (fresh_) {
    // in the middle of a glide, or without those that waited, the last answer is of no single level
    kept_ = left_ > 0 || last.waiting();
    const std::uint32_t quarter = (cycles_ + 3) / 4;
    span_ = changes ? cycles_ : left_ > quarter ? left_ : quarter;
    left_ = span_ - 1;
    from_ = to_;
    to_ = level;
  } else if (returns) {
    turn_back(last.contacts());
  } else if (moving_) {
    --left_;
  } else {
    to_ = level;
    left_ = 0;
  }
}

void Glide::foresee(std::uint32_t level, const LastAnswer& last, const float* force) noexcept {
  foreseen_level_ = level;
  for (std::uint32_t place = 0; place < last.contacts(); ++place) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      foreseen_difference_[3 * place + r] = last.force(place)[r] - force[3 * place + r];
    }
  }
}

GlideReport Glide::blend(std::span<const Constraint> contacts, const LastAnswer& last, const float* older,
                         float* force) noexcept {
  if (!moving_) {
    kept_weight_ = 0;
    return {};
  }
  kept_ = older == nullptr;
  const auto cycles = static_cast<float>(span_);
  const float weight = static_cast<float>(left_) / cycles;
  float largest = 0;
  double along = 0;  // displacements times this difference, and the one before; neither overflows
  double before = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t place = last.place(contacts[i].node);
    const float* const last_force = place == layout::none ? nullptr : last.force(place);
    for (std::size_t r = 0; r < 3; ++r) {
      float& newer = force[3 * i + r];
      const float was = last_force == nullptr ? 0 : difference_[std::size_t{3} * place + r];
      const float begun = last_force == nullptr ? 0
                          : foreseen_           ? foreseen_difference_[std::size_t{3} * place + r]
                                                : last_force[r] - newer;
      const float known = fresh_ ? begun : was;
      const float difference = older != nullptr ? older[3 * i + r] - newer : known;
      const float displacement = without_tiny(contacts[i].value[r]);
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
  return {1 - weight, largest, work};
}

}  // namespace greenloop
