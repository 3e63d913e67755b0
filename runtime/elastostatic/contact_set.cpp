#include "runtime/elastostatic/contact_set.hpp"

#include <cmath>

#include "runtime/algebra/merge_sort.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

bool finite(const Constraint& contact) {
  return std::isfinite(contact.value[0]) && std::isfinite(contact.value[1]) && std::isfinite(contact.value[2]);
}

using Kind = Constraint::Kind;

bool names_node(Kind kind) { return kind == Kind::hold || kind == Kind::force; }

bool names_mask(Kind kind) { return kind == Kind::pattern || kind == Kind::mask; }

Status check_node(std::uint32_t node, std::uint32_t node_count, const NodeFacts* facts) {
  if (node >= node_count) {
    return Status::held_out_of_range;
  }
  return facts[node].touchable ? Status::ok : Status::held_not_touchable;
}

bool finite(float weight) { return std::isfinite(weight); }
bool finite(const Vec3& part) { return std::isfinite(part.x) && std::isfinite(part.y) && std::isfinite(part.z); }

template <class Part>
Status check_parts(std::span<const std::uint32_t> nodes, std::span<const Part> parts, std::uint32_t node_count,
                   const NodeFacts* facts) {
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Status node = check_node(nodes[k], node_count, facts);
    if (node != Status::ok || !finite(parts[k])) {
      return node != Status::ok ? node : Status::held_not_finite;
    }
  }
  return Status::ok;
}

// takes `count` of what is left; false if that is less
bool take(std::size_t count, std::uint32_t& left) {
  const bool enough = count <= left;
  left -= enough ? static_cast<std::uint32_t>(count) : 0;
  return enough;
}

// left: nodes that there is room for
template <class Part>
Status check_pattern(const Constraint& constraint, std::span<const std::uint32_t> nodes, std::span<const Part> parts,
                     std::uint32_t node_count, const NodeFacts* facts, std::uint32_t& left) {
  if (nodes.empty() || parts.size() != nodes.size() || !take(nodes.size(), left)) {
    return Status::held_out_of_range;
  }
  return finite(constraint) ? check_parts(nodes, parts, node_count, facts) : Status::held_not_finite;
}

Status check_contact(const Constraint& contact, std::uint32_t node_count, const NodeFacts* facts) {
  const Status node = check_node(contact.node, node_count, facts);
  if (node != Status::ok) {
    return node;
  }
  if (!finite(contact)) {
    return Status::held_not_finite;
  }
  return facts[contact.node].marked ? Status::held_duplicate : Status::ok;
}

bool is_known(Kind kind, const ConstraintBounds& bounds) {
  switch (kind) {
    case Kind::hold:
      return true;
    case Kind::normal:
    case Kind::mask:
      return bounds.mixed;
    case Kind::force:
    case Kind::pattern:
    case Kind::along:
      return bounds.forces > 0;
  }
  return false;
}

// of a kind that is known; what `node` and `value` are follows from it
Status check_constraint(const Constraint& constraint, std::uint32_t node_count, const NodeFacts* facts,
                        ConstraintBounds& left) {
  std::uint32_t& room = is_contact(constraint) ? left.contacts : left.forces;
  if (names_node(constraint.kind)) {
    const Status status = check_contact(constraint, node_count, facts);
    return status != Status::ok || take(1, room) ? status : Status::held_out_of_range;
  }
  if (names_mask(constraint.kind)) {
    const Mask mask = constraint.node < left.masks.size() ? left.masks[constraint.node] : Mask{};
    return check_pattern(constraint, mask.node, mask.weight, node_count, facts, room);
  }
  const DirectedMask mask = constraint.node < left.directed.size() ? left.directed[constraint.node] : DirectedMask{};
  return check_pattern(constraint, mask.node, mask.part, node_count, facts, room);
}

CheckedContacts check_all(std::span<const Constraint> constraints, std::uint32_t node_count, NodeFacts* facts,
                          const ConstraintBounds& bounds) {
  CheckedContacts result;
  ConstraintBounds left = bounds;
  std::size_t checked = 0;
  for (; checked < constraints.size(); ++checked) {
    result.status = is_known(constraints[checked].kind, bounds)
                        ? check_constraint(constraints[checked], node_count, facts, left)
                        : Status::held_unsupported;
    if (result.status != Status::ok) {
      result.refused = static_cast<std::uint32_t>(checked);
      break;
    }
    if (names_node(constraints[checked].kind)) {
      facts[constraints[checked].node].marked = true;
    }
  }
  for (std::size_t i = 0; i < checked; ++i) {
    if (names_node(constraints[i].kind)) {
      facts[constraints[i].node].marked = false;
    }
  }
  return result;
}

}  // namespace

void list_node_facts(const ModelView& view, NodeFacts* facts) noexcept {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const bool touchable = (level.nodes[i].flags & layout::node_touchable) != 0;
      facts[level.node_begin + i] = NodeFacts{static_cast<std::uint8_t>(q), touchable, false};
    }
  }
}

CheckedContacts check_contacts(std::span<const Constraint> contacts, std::uint32_t node_count, NodeFacts* facts,
                               const ConstraintBounds& bounds) noexcept {
  return bounds.forces > 0 || bounds.mixed ? check_all(contacts, node_count, facts, bounds)
                                           : check_holds(contacts, node_count, facts, bounds.contacts);
}

CheckedContacts check_holds(std::span<const Constraint> contacts, std::uint32_t node_count, NodeFacts* facts,
                            std::uint32_t most) noexcept {
  CheckedContacts result;
  std::size_t checked = 0;
  for (; checked < contacts.size(); ++checked) {
    const bool holds = contacts[checked].kind == Kind::hold;
    const bool room = checked < most;
    result.status = !holds  ? Status::held_unsupported
                    : !room ? Status::held_out_of_range
                            : check_contact(contacts[checked], node_count, facts);
    if (result.status != Status::ok) {
      result.refused = static_cast<std::uint32_t>(checked);
      break;
    }
    facts[contacts[checked].node].marked = true;
  }
  for (std::size_t i = 0; i < checked; ++i) {
    facts[contacts[i].node].marked = false;
  }
  return result;
}

void ContactSet::carve(Arena& arena, std::uint32_t contacts) noexcept {
  column = arena.take<std::uint32_t>(contacts);
  place = arena.take<std::uint32_t>(contacts);
  members = arena.take<std::uint32_t>(contacts);
}

void ResolutionScratch::carve(Arena& arena, std::uint32_t contacts, std::uint64_t domain) noexcept {
  sorting = arena.take<std::uint32_t>(contacts);
  index_of_place = arena.take<std::uint32_t>(domain);
}

std::uint32_t column_of(const ModelView& view, const NodeFacts* facts, std::uint32_t node,
                        std::uint32_t level) noexcept {
  const std::uint32_t mesh_level = facts[node].mesh_level;
  const std::uint32_t representative =
      view.representatives[level][mesh_level][node - view.level[mesh_level].node_begin];
  return make_column(level, domain_place(view, facts[representative].mesh_level, representative));
}

void resolve_contacts(std::span<const Constraint> contacts, const ModelView& view, const NodeFacts* facts,
                      std::uint32_t level, ResolutionScratch& scratch, ContactSet& set) noexcept {
  set.columns = set.waiting = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t column = column_of(view, facts, contacts[i].node, level);
    set.place[i] = column_place(column);
    std::uint32_t& index = scratch.index_of_place[column_place(column)];
    if (index == layout::none) {
      index = 0;
      set.column[set.columns++] = column;
    }
  }
  merge_sort(set.columns, set.column, scratch.sorting, [](std::uint32_t a, std::uint32_t b) { return a < b; });
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    scratch.index_of_place[column_place(set.column[k])] = k;
    set.members[k] = 0;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    set.place[i] = scratch.index_of_place[set.place[i]];
    ++set.members[set.place[i]];
  }
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    scratch.index_of_place[column_place(set.column[k])] = layout::none;
  }
}

void leave_out(ColumnSet columns, std::size_t contacts, ResolutionScratch& scratch, ContactSet& set) noexcept {
  std::uint32_t* const new_place = scratch.sorting;
  std::uint32_t kept = 0;
  std::uint32_t out = 0;
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    const bool leaves = out < columns.count && set.column[k] == columns.column[out];
    new_place[k] = leaves ? layout::none : kept;
    if (leaves) {
      ++out;
    } else {
      set.column[kept] = set.column[k];
      set.members[kept++] = set.members[k];
    }
  }
  set.columns = kept;
  for (std::size_t i = 0; i < contacts; ++i) {
    set.place[i] = new_place[set.place[i]];
    set.waiting += set.holds(i) ? 0 : 1;
  }
}

void average_displacements(std::span<const Constraint> contacts, const ContactSet& set, float* displacement) noexcept {
  for (std::uint32_t k = 0; k < 3 * set.columns; ++k) {
    displacement[k] = 0;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    float* sum = displacement + std::size_t{3} * set.place[i];
    for (std::uint32_t r = 0; set.holds(i) && r < 3; ++r) {
      sum[r] += contacts[i].value[r];
    }
  }
  for (std::uint32_t k = 0; k < set.columns; ++k) {
    const auto members = static_cast<float>(set.members[k]);
    for (std::uint32_t r = 0; r < 3; ++r) {
      displacement[3 * k + r] = without_tiny(displacement[3 * k + r] / members);
    }
  }
}

void share_forces(const float* column_force, std::size_t contacts, const ContactSet& set,
                  float* contact_force) noexcept {
  for (std::size_t i = 0; i < contacts; ++i) {
    const std::uint32_t k = set.place[i];
    for (std::uint32_t r = 0; r < 3; ++r) {
      contact_force[3 * i + r] = set.holds(i) ? column_force[3 * k + r] / static_cast<float>(set.members[k]) : 0;
    }
  }
}

}  // namespace greenloop
