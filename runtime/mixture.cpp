#include "runtime/mixture.hpp"

#include <cstring>

namespace greenloop {
namespace {

// squares of what the contacts of a group differ by from their mean
float unsaid(std::span<const Contact> contacts, std::span<const std::uint32_t> group) {
  float mean[3] = {};
  for (const std::uint32_t i : group) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      mean[r] += without_denormals(contacts[i].displacement[r]);
    }
  }
  float sum = 0;
  for (const std::uint32_t i : group) {
    for (std::uint32_t r = 0; r < 3; ++r) {
      const float difference =
          without_denormals(contacts[i].displacement[r]) - mean[r] / static_cast<float>(group.size());
      sum += difference * difference;
    }
  }
  return sum;
}

}  // namespace

void Mixture::carve(Arena& arena, std::uint32_t contacts) noexcept {
  column_ = arena.take<std::uint32_t>(contacts);
  begin_ = arena.take<std::uint32_t>(contacts + std::uint64_t{1});
  member_ = arena.take<std::uint32_t>(contacts);
  order_ = arena.take<std::uint32_t>(contacts);
  sorting_ = arena.take<std::uint32_t>(contacts);
  unsaid_ = arena.take<float>(contacts);
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

void Mixture::rank(std::span<const Contact> contacts, const ContactSet& set, const NodeFacts* facts) noexcept {
  groups_ = set.columns;
  std::memcpy(column_, set.column, sizeof(std::uint32_t) * groups_);
  list_members(set, contacts.size());
  for (std::uint32_t k = 0; k < groups_; ++k) {
    order_[k] = k;
    const auto group = contacts_of(k);
    const float kept = facts[contacts[group[0]].node].fine ? 4.0F : 1.0F;
    unsaid_[k] = kept * unsaid(contacts, group);
  }
  merge_sort(groups_, order_, sorting_, [this](std::uint32_t a, std::uint32_t b) { return unsaid_[a] > unsaid_[b]; });
}

void Mixture::choose(std::uint32_t groups, std::span<const Contact> contacts, NodeFacts* facts) noexcept {
  for (std::uint32_t k = 0; k < last_; ++k) {
    facts[last_node_[k]].fine = false;
  }
  last_ = 0;
  std::memset(fine_, 0, contacts.size());
  for (std::uint32_t g = 0; g < groups; ++g) {
    for (const std::uint32_t i : contacts_of(g)) {
      fine_[i] = true;
      facts[contacts[i].node].fine = true;
      last_node_[last_++] = contacts[i].node;
    }
  }
}

}  // namespace greenloop
