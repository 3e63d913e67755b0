#include "runtime/elastostatic/mixture.hpp"

#include <algorithm>
#include <cstring>

namespace greenloop {
namespace {

// square of the force of a group in the last answer
float square_force(std::span<const Constraint> contacts, std::span<const std::uint32_t> group, const LastAnswer& last) {
  float force[3] = {};
  for (const std::uint32_t i : group) {
    const std::uint32_t place = last.place(contacts[i].node);
    for (std::uint32_t r = 0; place != layout::none && r < 3; ++r) {
      force[r] += last.force(place)[r];
    }
  }
  return force[0] * force[0] + force[1] * force[1] + force[2] * force[2];
}

}  // namespace

void Mixture::carve(Arena& arena, std::uint32_t contacts) noexcept {
  column_ = arena.take<std::uint32_t>(contacts);
  begin_ = arena.take<std::uint32_t>(contacts + std::uint64_t{1});
  member_ = arena.take<std::uint32_t>(contacts);
  order_ = arena.take<std::uint32_t>(contacts);
  sorting_ = arena.take<std::uint32_t>(contacts);
  weight_ = arena.take<float>(contacts);
  kept_ = arena.take<bool>(contacts);
  fine_ = arena.take<bool>(contacts);
  last_node_ = arena.take<std::uint32_t>(contacts);
}

void Mixture::list_members(const ContactSet& set, std::size_t contacts) noexcept {
  std::uint32_t end = 0;
  for (std::uint32_t k = 0; k < groups_; ++k) {
    begin_[k] = end;
    end += set.members[k];
  }
  for (std::size_t i = 0; i < contacts; ++i) {
    member_[begin_[set.place[i]]++] = static_cast<std::uint32_t>(i);
  }
  std::memmove(begin_ + 1, begin_, sizeof(std::uint32_t) * groups_);
  begin_[0] = 0;
}

void Mixture::rank(std::span<const Constraint> contacts, const ContactSet& set, const NodeFacts* facts,
                   const LastAnswer& last) noexcept {
  groups_ = set.columns;
  std::memset(fine_, 0, contacts.size());
  std::memcpy(column_, set.column, sizeof(std::uint32_t) * groups_);
  list_members(set, contacts.size());
  for (std::uint32_t k = 0; k < groups_; ++k) {
    order_[k] = k;
    const auto group = contacts_of(k);
    kept_[k] = std::any_of(group.begin(), group.end(), [&](std::uint32_t i) { return facts[contacts[i].node].fine; });
    weight_[k] = (kept_[k] ? 4.0F : 1.0F) * square_force(contacts, group, last);
  }
  merge_sort(groups_, order_, sorting_, [this](std::uint32_t a, std::uint32_t b) { return weight_[a] > weight_[b]; });
}

void Mixture::choose(std::uint32_t g) noexcept {
  for (const std::uint32_t i : contacts_of(g)) {
    fine_[i] = true;
  }
}

void Mixture::remember(bool answered, std::uint32_t level, std::span<const Constraint> contacts,
                       NodeFacts* facts) noexcept {
  last_level_ = level;
  for (std::uint32_t k = 0; k < last_; ++k) {
    facts[last_node_[k]].fine = false;
  }
  last_ = 0;
  for (std::uint32_t i = 0; answered && i < contacts.size(); ++i) {
    if (fine_[i]) {
      facts[contacts[i].node].fine = true;
      last_node_[last_++] = contacts[i].node;
    }
  }
}

}  // namespace greenloop
