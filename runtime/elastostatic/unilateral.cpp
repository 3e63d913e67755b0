#include "runtime/elastostatic/unilateral.hpp"

#include <cmath>

namespace greenloop {
namespace {

float dot3(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool all_finite(const UnilateralContact& c) {
  float sum = c.friction + c.softness + c.mount;
  for (int r = 0; r < 3; ++r) {
    sum += std::fabs(c.value[r]) + std::fabs(c.normal[r]) + std::fabs(c.force[r]) + std::fabs(c.weight[r]);
  }
  return std::isfinite(sum);
}

Status check_unilateral(const UnilateralContact& c, std::uint32_t node_count, std::uint32_t& corners) {
  if (!all_finite(c)) {
    return Status::held_not_finite;
  }
  const float square = dot3(c.normal, c.normal);
  constexpr float least = 0.998F, most = 1.002F, whole = 1.001F;
  float weights = 0;
  bool weighted = true;
  corners = 0;
  for (int k = 0; k < 3; ++k) {
    if (c.node[k] == UnilateralContact::none) {
      continue;
    }
    if (c.node[k] >= node_count) {
      return Status::held_out_of_range;
    }
    ++corners;
    weights += c.weight[k];
    weighted = weighted && c.weight[k] > 0;
  }
  const bool stands = corners > 0 ? weighted && weights <= whole : c.softness > 0;
  return square >= least && square <= most && c.friction >= 0 && c.softness >= 0 && c.mount >= 0 && stands
             ? Status::ok
             : Status::held_bad_surface;
}

std::span<const UnilateralCorner> corners_of(const UnilateralScratch& scratch, std::uint32_t contact) {
  return {scratch.corner + scratch.begin[contact], scratch.corner + scratch.begin[contact + 1]};
}

// between the points of two contacts
Block<3> block_between(const UnilateralSet& all, const Factor& factor, std::uint32_t stride,
                       const UnilateralScratch& scratch, std::uint32_t i, std::uint32_t j) {
  Block<3> sum{};
  for (const UnilateralCorner& row : corners_of(scratch, i)) {
    for (const UnilateralCorner& column : corners_of(scratch, j)) {
      float block[9];
      kept_block<3>(factor, stride, all.set.place[row.hold], all.set.place[column.hold], block);
      const Float4 weight = splat(row.weight * column.weight);
      for (std::size_t c = 0; c < 3; ++c) {
        sum.column[c] += weight * load_vector<3>(block + 3 * c);
      }
    }
  }
  return sum;
}

// whether columns hold all that a contact's point hangs on
bool is_held(const UnilateralSet& all, const UnilateralScratch& scratch, std::uint32_t contact) {
  bool held = true;
  for (const UnilateralCorner& corner : corners_of(scratch, contact)) {
    held = held && all.set.holds(corner.hold);
  }
  return held;
}

// adds to `sum` how far a contact's point is displaced without contact forces
Float4 add_displaced(const UnilateralSet& all, const UnilateralScratch& scratch, std::uint32_t i, Float4 sum) {
  for (const UnilateralCorner& corner : corners_of(scratch, i)) {
    if (all.displaced != nullptr) {
      sum += splat(corner.weight) * load_vector<3>(all.displaced + std::size_t{3} * all.set.place[corner.hold]);
    }
  }
  return without_denormals(sum);
}

ContactCandidate candidate_of(const UnilateralSet& all, const UnilateralScratch& scratch, std::uint32_t i) {
  const UnilateralContact& contact = all.contacts[i];
  const Float4 gap = add_displaced(all, scratch, i, -load_vector<3>(contact.value));
  const float scale = 1 / std::sqrt(dot3(contact.normal, contact.normal));
  ContactCandidate candidate;
  candidate.gap = {gap[0], gap[1], gap[2], 0};
  candidate.normal = {scale * contact.normal[0], scale * contact.normal[1], scale * contact.normal[2], 0};
  candidate.friction = contact.friction;
  return candidate;
}

void add_softness(float softness, Block<3>& block) {
  block.column[0] += Float4{softness, 0, 0, 0};
  block.column[1] += Float4{0, softness, 0, 0};
  block.column[2] += Float4{0, 0, softness, 0};
}

// Of a tool that hangs on a spring: its contacts give way together. The lesser of two is positive definite if they
// differ.
float mount_between(const UnilateralContact& a, const UnilateralContact& b) {
  const float lesser = a.mount < b.mount ? a.mount : b.mount;
  return a.tool == b.tool ? lesser : 0;
}

// the contacts that are held as candidates, and the compliance between them; how many
std::uint32_t gather(const UnilateralSet& all, const Factor& factor, std::uint32_t stride, UnilateralScratch& scratch) {
  std::uint32_t count = 0;
  const float share = 1 / all.stiffness;
  for (std::uint32_t i = 0; i < all.contacts.size(); ++i) {
    if (is_held(all, scratch, i)) {
      const float* guess = all.contacts[i].force;
      scratch.candidate[count] = candidate_of(all, scratch, i);
      scratch.force[count] = {share * guess[0], share * guess[1], share * guess[2], 0};
      scratch.contact[count++] = i;
    }
  }
  for (std::uint32_t j = 0; j < count; ++j) {
    Block<3>* const column = scratch.compliance.column(j);
    const UnilateralContact& contact = all.contacts[scratch.contact[j]];
    for (std::uint32_t i = 0; i <= j; ++i) {
      column[i] = block_between(all, factor, stride, scratch, scratch.contact[i], scratch.contact[j]);
      const float mount = mount_between(all.contacts[scratch.contact[i]], contact);
      if (mount > 0) add_softness(mount * all.stiffness, column[i]);
    }
    // of the surface itself, whose forces are not over the stiffness scale
    add_softness(contact.softness * all.stiffness, column[j]);
  }
  return scratch.held = count;
}

// how far its own force pushes a contact along its normal, m
float yield_of(const UnilateralScratch& scratch, std::uint32_t held) {
  const Float4 pushed = product(scratch.compliance.at(held, held), load_vector<3>(&scratch.force[held].x));
  const Vec4& n = scratch.candidate[held].normal;
  const float along = pushed[0] * n.x + pushed[1] * n.y + pushed[2] * n.z;
  return along > 0 ? along : 0;
}

void add_to_columns(const UnilateralSet& all, const UnilateralScratch& scratch, std::uint32_t count,
                    float* column_force) {
  for (std::uint32_t k = 0; k < 3 * all.set.columns; ++k) {
    column_force[k] = 0;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec4& force = scratch.force[i];
    for (const UnilateralCorner& corner : corners_of(scratch, scratch.contact[i])) {
      float* const sum = column_force + std::size_t{3} * all.set.place[corner.hold];
      sum[0] += corner.weight * force.x;
      sum[1] += corner.weight * force.y;
      sum[2] += corner.weight * force.z;
    }
  }
}

}  // namespace

void UnilateralScratch::carve(Arena& arena, std::uint32_t contacts, std::uint32_t nodes,
                              const Prices& prices) noexcept {
  hold = arena.take<Constraint>(contacts);
  corner = arena.take<UnilateralCorner>(contacts);
  begin = arena.take<std::uint32_t>(contacts + 1);
  hold_of_node = arena.take<std::uint32_t>(nodes);
  hold_force = arena.take<float>(std::uint64_t{3} * contacts);
  contact = arena.take<std::uint32_t>(contacts);
  candidate = arena.take<ContactCandidate>(contacts);
  force = arena.take<Vec4>(contacts);
  gap = arena.take<Vec4>(contacts);
  state = arena.take<ContactState>(contacts);
  compliance.block = arena.take<Block<3>>(ContactCompliance::size(contacts));
  problem.carve(arena, contacts, prices);
  builder.carve(arena, contacts);
  point = arena.take<ToolPoint>(contacts);
  for (std::uint32_t node = 0; hold_of_node != nullptr && node < nodes; ++node) {
    hold_of_node[node] = UnilateralContact::none;
  }
}

CheckedContacts list_unilateral(std::span<const UnilateralContact> contacts, std::uint32_t node_count,
                                std::uint32_t most, UnilateralScratch& scratch, std::uint32_t& holds) noexcept {
  CheckedContacts result;
  std::uint32_t corners = 0;
  holds = 0;
  for (std::uint32_t i = 0; i < contacts.size() && result.status == Status::ok; ++i) {
    std::uint32_t of_this = 0;
    result.status = check_unilateral(contacts[i], node_count, of_this);
    if (result.status == Status::ok && corners + of_this > most) {
      result.status = Status::held_out_of_range;
    }
    if (result.status != Status::ok) {
      result.refused = i;
      break;
    }
    scratch.begin[i] = corners;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = contacts[i].node[k];
      if (node == UnilateralContact::none) {
        continue;
      }
      std::uint32_t& place = scratch.hold_of_node[node];
      if (place == UnilateralContact::none) {
        place = holds;
        scratch.hold[holds++] = {node, {}};
      }
      scratch.corner[corners++] = {place, contacts[i].weight[k]};
    }
    scratch.begin[i + 1] = corners;
  }
  for (std::uint32_t i = 0; i < holds; ++i) {
    scratch.hold_of_node[scratch.hold[i].node] = UnilateralContact::none;
  }
  return result;
}

std::uint32_t contact_of(const UnilateralScratch& scratch, std::uint32_t hold) noexcept {
  std::uint32_t corner = 0;
  while (scratch.corner[corner].hold != hold) {
    ++corner;
  }
  std::uint32_t contact = 0;
  while (scratch.begin[contact + 1] <= corner) {
    ++contact;
  }
  return contact;
}

std::uint64_t gather_unilateral_work(const Prices& prices, std::uint64_t corners) noexcept {
  return priced(corners, prices.solved_contact) + priced(9 * ContactCompliance::size(corners), prices.appended);
}

std::uint64_t unilateral_work(const Prices& prices, std::uint64_t corners, std::uint64_t iterations) noexcept {
  return gather_unilateral_work(prices, corners) + iterations * ContactProblem::least_work(prices, corners);
}

ContactAnswer solve_unilateral(const UnilateralSet& all, const Factor& factor, std::uint32_t stride,
                               const ContactAccuracy& accuracy, std::uint64_t allowance, UnilateralScratch& scratch,
                               float* column_force) noexcept {
  const std::uint32_t count = gather(all, factor, stride, scratch);
  ContactAnswer answer;
  answer.valid = true;
  if (count > 0) {
    answer = scratch.problem.solve({scratch.candidate, count}, scratch.compliance, accuracy, allowance,
                                   {scratch.force, count}, {scratch.state, count}, {scratch.gap, count});
  }
  add_to_columns(all, scratch, count, column_force);
  return answer;
}

void place_contacts(const UnilateralSet& all, const UnilateralScratch& scratch, std::span<Vec4> displacement) noexcept {
  for (std::uint32_t k = 0; k < scratch.held; ++k) {
    const std::uint32_t i = scratch.contact[k];
    const std::span<const UnilateralCorner> corners = corners_of(scratch, i);
    if (corners.size() != 1 || corners[0].weight != 1) continue;
    const std::uint32_t node = scratch.hold[corners[0].hold].node;
    if (node >= displacement.size()) continue;
    const float* const value = all.contacts[i].value;
    const Vec4& gap = scratch.gap[k];
    displacement[node] = {without_tiny(value[0] + gap.x), without_tiny(value[1] + gap.y),
                          without_tiny(value[2] + gap.z), 0};
  }
}

void hand_out_unilateral(const UnilateralSet& all, UnilateralScratch& scratch,
                         const UnilateralOutput& output) noexcept {
  const auto contacts = static_cast<std::uint32_t>(all.contacts.size());
  for (std::uint32_t k = 0; k < 3 * scratch.begin[contacts]; ++k) {
    scratch.hold_force[k] = 0;
  }
  std::uint32_t held = 0;
  for (std::uint32_t i = 0; i < contacts; ++i) {
    const bool waits = !is_held(all, scratch, i);
    const Vec4 f = waits ? Vec4{} : scratch.force[held];
    for (const UnilateralCorner& corner : corners_of(scratch, i)) {
      float* const sum = scratch.hold_force + std::size_t{3} * corner.hold;
      sum[0] += corner.weight * f.x;
      sum[1] += corner.weight * f.y;
      sum[2] += corner.weight * f.z;
    }
    output.force[i] = {all.stiffness * f.x, all.stiffness * f.y, all.stiffness * f.z};
    if (!output.state.empty()) {
      output.state[i] = waits ? ContactState::open : scratch.state[held];
    }
    if (!output.gap.empty()) {
      output.gap[i] = waits ? Vec4{} : scratch.gap[held];
    }
    if (!output.yield.empty()) {
      output.yield[i] = waits ? 0 : yield_of(scratch, held);
    }
    if (!output.by_loads.empty()) {
      const Float4 displaced = waits ? Float4{} : add_displaced(all, scratch, i, Float4{});
      output.by_loads[i] = {displaced[0], displaced[1], displaced[2], 0};
    }
    held += waits ? 0 : 1;
  }
}

}  // namespace greenloop
