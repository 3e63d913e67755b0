#include "runtime/elastostatic/unilateral.hpp"

#include <cmath>

namespace greenloop {
namespace {

// Of a cone that forces are brought back to: what rounding of their components in space cannot leave.
constexpr float inside_cone = 1 - 0x1p-20F;

float dot3(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// a column's block of the compliance with another, out of what a factor keeps: its lower triangle by columns
Block<3> kept_block(const Factor& factor, std::uint32_t stride, std::uint32_t row, std::uint32_t column) {
  const std::size_t i = std::size_t{3} * factor.position[row];
  const std::size_t j = std::size_t{3} * factor.position[column];
  Block<3> block;
  for (std::size_t c = 0; c < 3; ++c) {
    float lane[3];
    for (std::size_t r = 0; r < 3; ++r) {
      const std::size_t a = i + r, b = j + c;
      lane[r] = factor.capacitance[a > b ? b * stride + a : a * stride + b];
    }
    block.column[c] = load_vector<3>(lane);
  }
  return block;
}

// displaced: its column, m, without contact forces
ContactCandidate candidate_of(const UnilateralContact& contact, const float* displaced) {
  const float scale = 1 / std::sqrt(dot3(contact.normal, contact.normal));
  float gap[3];
  for (int r = 0; r < 3; ++r) {
    gap[r] = without_tiny((displaced == nullptr ? 0 : displaced[r]) - contact.value[r]);
  }
  ContactCandidate candidate;
  candidate.gap = {gap[0], gap[1], gap[2], 0};
  candidate.normal = {scale * contact.normal[0], scale * contact.normal[1], scale * contact.normal[2], 0};
  candidate.friction = contact.friction;
  return candidate;
}

Vec4 last_force(const LastAnswer& last, std::uint32_t node) {
  const std::uint32_t place = last.place(node);
  if (place == layout::none) {
    return {};
  }
  const float* force = last.force(place);
  return {force[0], force[1], force[2], 0};
}

// the contacts that are held as candidates, and the compliance between them; how many
std::uint32_t gather(const UnilateralSet& all, const Factor& factor, std::uint32_t stride, const LastAnswer& last,
                     UnilateralScratch& scratch) {
  const ContactSet& set = all.set;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < all.contacts.size(); ++i) {
    if (set.holds(i)) {
      const float* displaced = all.displaced == nullptr ? nullptr : all.displaced + std::size_t{3} * set.place[i];
      scratch.candidate[count] = candidate_of(all.contacts[i], displaced);
      scratch.force[count] = last_force(last, all.contacts[i].node);
      scratch.contact[count++] = i;
    }
  }
  for (std::uint32_t j = 0; j < count; ++j) {
    Block<3>* const column = scratch.compliance.column(j);
    for (std::uint32_t i = 0; i <= j; ++i) {
      column[i] = kept_block(factor, stride, set.place[scratch.contact[i]], set.place[scratch.contact[j]]);
    }
  }
  return count;
}

// the part of a force along a contact's normal; along: the rest
float split(const UnilateralContact& contact, const float* force, float (&along)[3]) {
  const float normal = dot3(contact.normal, force) / dot3(contact.normal, contact.normal);
  for (int r = 0; r < 3; ++r) {
    along[r] = force[r] - normal * contact.normal[r];
  }
  return normal;
}

}  // namespace

void UnilateralScratch::carve(Arena& arena, std::uint32_t contacts) noexcept {
  hold = arena.take<Constraint>(contacts);
  contact = arena.take<std::uint32_t>(contacts);
  candidate = arena.take<ContactCandidate>(contacts);
  force = arena.take<Vec4>(contacts);
  compliance.block = arena.take<Block<3>>(ContactCompliance::size(contacts));
  problem.carve(arena, contacts);
}

CheckedContacts check_unilateral(std::span<const UnilateralContact> contacts, Constraint* hold) noexcept {
  CheckedContacts result;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const UnilateralContact& contact = contacts[i];
    const float square = dot3(contact.normal, contact.normal);
    constexpr float least = 0.998F, most = 1.002F;
    const bool finite = std::isfinite(square) && std::isfinite(contact.friction);
    const bool good = square >= least && square <= most && contact.friction >= 0;
    if (result.status == Status::ok && !(finite && good)) {
      result.status = finite ? Status::held_bad_surface : Status::held_not_finite;
      result.refused = static_cast<std::uint32_t>(i);
    }
    hold[i] = {contact.node, {contact.value[0], contact.value[1], contact.value[2]}};
  }
  return result;
}

std::uint64_t unilateral_iteration_work(const Prices&, std::uint64_t contacts) noexcept {
  return ContactProblem::iteration_work(contacts);
}

std::uint64_t unilateral_work(const Prices& prices, std::uint64_t contacts, std::uint64_t iterations) noexcept {
  return priced(contacts, prices.solved_contact) + priced(9 * ContactCompliance::size(contacts), prices.appended) +
         ContactProblem::least_work(contacts) + (iterations - 1) * unilateral_iteration_work(prices, contacts);
}

ContactAnswer solve_unilateral(const UnilateralSet& all, const Factor& factor, std::uint32_t stride,
                               const LastAnswer& last, const ContactAccuracy& accuracy, UnilateralScratch& scratch,
                               float* column_force) noexcept {
  const ContactSet& set = all.set;
  const std::uint32_t count = gather(all, factor, stride, last, scratch);
  constexpr std::uint64_t any = ~std::uint64_t{0};
  const ContactAnswer answer = scratch.problem.solve({scratch.candidate, count}, scratch.compliance, accuracy, any,
                                                     {scratch.force, count}, {}, {});
  for (std::uint32_t k = 0; k < 3 * set.columns; ++k) {
    column_force[k] = 0;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    float* const sum = column_force + std::size_t{3} * set.place[scratch.contact[i]];
    sum[0] += scratch.force[i].x;
    sum[1] += scratch.force[i].y;
    sum[2] += scratch.force[i].z;
  }
  return answer;
}

void unilateral_forces(const UnilateralScratch& scratch, const ContactSet& set, std::size_t contacts,
                       float* force) noexcept {
  std::uint32_t held = 0;
  for (std::size_t i = 0; i < contacts; ++i) {
    const Vec4 f = set.holds(i) ? scratch.force[held++] : Vec4{};
    force[3 * i] = f.x;
    force[3 * i + 1] = f.y;
    force[3 * i + 2] = f.z;
  }
}

void push_only(std::span<const UnilateralContact> contacts, float* force) noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    float* const f = force + 3 * i;
    float along[3];
    const float part = split(contacts[i], f, along);
    const float normal = part > 0 ? part : 0;
    const float size = std::sqrt(dot3(along, along));
    const float most = contacts[i].friction * normal * inside_cone;
    const float scale = size <= most ? 1 : most / size;
    for (int r = 0; r < 3; ++r) {
      f[r] = normal * contacts[i].normal[r] + scale * along[r];
    }
  }
}

void list_states(std::span<const UnilateralContact> contacts, const float* force,
                 std::span<ContactState> state) noexcept {
  constexpr float nearly = 1 - 0x1p-16F;
  for (std::size_t i = 0; i < state.size(); ++i) {
    float along[3];
    const float normal = split(contacts[i], force + 3 * i, along);
    const bool slips = std::sqrt(dot3(along, along)) >= nearly * contacts[i].friction * normal;
    state[i] = !(normal > 0) ? ContactState::open : slips ? ContactState::slip : ContactState::stick;
  }
}

}  // namespace greenloop
