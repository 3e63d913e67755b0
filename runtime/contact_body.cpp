#include "runtime/contact_body.hpp"

#include <cmath>
#include <limits>

#include "runtime/contact_body/answer.hpp"
#include "runtime/contact_body/touching_work.hpp"

namespace greenloop {
namespace {

double larger(double a, double b) { return a > b ? a : b; }

// displacement of a candidate's point that its touchable corners have a part in
Double3 pushed_displacement(const TouchedBody& body, const Candidate& candidate) {
  Double3 sum;
  for (int k = 0; k < 3 && candidate.node[k] != layout::none; ++k) {
    const Vec4& u = body.displacement[candidate.node[k]];
    if (body.deformed.is_touchable(candidate.node[k])) sum += candidate.weight[k] * Double3{u.x, u.y, u.z};
  }
  return sum;
}

void put(float (&to)[3], const Double3& from) {
  to[0] = static_cast<float>(from.x);
  to[1] = static_cast<float>(from.y);
  to[2] = static_cast<float>(from.z);
}

// corners with less hardly move the point, and its compliance would vanish in rounding
constexpr float least_weight = 1e-6F;

// touchable corners of a candidate; how many
std::uint32_t put_corners(const TouchedBody& body, const Candidate& candidate, UnilateralContact& contact) {
  std::uint32_t corners = 0;
  for (int k = 0; k < 3 && candidate.node[k] != layout::none; ++k) {
    const auto weight = static_cast<float>(candidate.weight[k]);
    if (weight > least_weight && body.deformed.is_touchable(candidate.node[k])) {
      contact.node[corners] = candidate.node[k];
      contact.weight[corners++] = weight;
    }
  }
  return corners;
}

// where a contact's point has to go to stand on the tool where it touched it, without slipping, from where it is
Double3 way_to_stick(const TouchedBody& body, const Candidate& candidate, const Grip* grip) {
  const Double3& n = candidate.normal;
  const Double3 out = -candidate.gap * n;
  if (grip == nullptr || !grip->touches) return out;
  // of another point than the last step's nothing is known but that the tool has moved
  const Double3 anchor =
      grip->is_at(candidate) ? grip->anchor : body.last_placement[candidate.tool].to_tool(candidate.position);
  const Double3 way = body.placement[candidate.tool].to_model(anchor) - candidate.position;
  return out + way - dot(n, way) * n;
}

// of a place of the surface, on the tools' coefficients
double friction_factor(const TouchedBody& body, const Candidate& candidate) {
  if (body.factor.empty()) return 1;
  double sum = 0;
  for (int k = 0; k < 3 && candidate.node[k] != layout::none; ++k) {
    sum += candidate.weight[k] * double{body.factor[candidate.node[k]]};
  }
  return sum;
}

// stick_place: m, where its point stands if it does not slip and the tool's spring gives way no further
UnilateralContact contact_of(const TouchedBody& body, const Candidate& candidate, const Grip* grip,
                             const ContactBody::ToolInput& tool, Double3& stick_place) {
  UnilateralContact contact;
  const std::uint32_t corners = put_corners(body, candidate, contact);
  const Double3 way = way_to_stick(body, candidate, grip);
  stick_place = candidate.position + way;
  put(contact.value, pushed_displacement(body, candidate) + way - body.sag[candidate.tool]);
  put(contact.normal, candidate.normal);
  contact.friction = static_cast<float>(tool.friction * friction_factor(body, candidate));
  contact.tool = candidate.tool;
  contact.mount = static_cast<float>(tool.compliance);
  float held = 1;  // by corners that cannot move
  for (std::uint32_t k = 0; k < corners; ++k) held -= contact.weight[k];
  contact.softness = held > least_weight ? held * body.rigid_softness : 0;
  if (grip != nullptr) {
    contact.force[0] = grip->force.x;
    contact.force[1] = grip->force.y;
    contact.force[2] = grip->force.z;
  }
  return contact;
}

std::uint32_t corners_of(const TouchedBody& body, const Candidate& candidate) {
  UnilateralContact contact;
  const std::uint32_t corners = put_corners(body, candidate, contact);
  return corners > 0 ? corners : 1;
}

// Whether nodes alone say where the candidate's tool touches: it is larger than the triangles, and some can be pushed.
bool is_said_by_nodes(const TouchedBody& body, const Candidate& candidate) {
  if (candidate.triangle == layout::none) return false;
  UnilateralContact contact;
  return body.tool[candidate.tool].shape.point_radius() >= 2 * body.mean_edge &&
         put_corners(body, candidate, contact) > 0;
}

// A point of a tool stays where it sticks to the surface, instead of sliding to the nearest place.
void hold_place(const TouchedBody& body, const Grip* grip, Candidate& candidate) {
  if (grip == nullptr || !grip->sticks || candidate.triangle == layout::none) return;
  Double3 place;
  for (int k = 0; k < 3; ++k) {
    candidate.node[k] = grip->node[k];
    candidate.weight[k] = grip->weight[k];
    place += grip->weight[k] * body.deformed.position(grip->node[k]);
  }
  candidate.gap += dot(candidate.normal, place - candidate.position);
  candidate.position = place;
}

// takes the candidates in, where their places stick
std::span<Candidate> take_candidates(TouchedBody& body, std::span<const Candidate> found) {
  body.grips.begin();
  for (std::size_t i = 0; i < found.size(); ++i) {
    body.candidate[i] = found[i];
    hold_place(body, body.grips.find(grip_key(found[i])), body.candidate[i]);
  }
  return {body.candidate, found.size()};
}

// candidates, of which this one is the deepest
void leave_out(const Candidate& deepest, std::uint32_t count, ContactBody::StepReport& report) {
  if (report.left_out == 0 || -deepest.gap > report.deepest_left_out) {
    report.deepest_left_out = -deepest.gap;
    report.left_out_place.tool = deepest.tool;
    for (int k = 0; k < 3; ++k) {
      report.left_out_place.node[k] = deepest.node[k];
      report.left_out_place.weight[k] = deepest.weight[k];
    }
  }
  report.left_out += count;
}

// the candidates that there is room for, by their corners: while there is none, those of triangles farthest from the
// tool are left out, which hang on nodes that may be candidates themselves
std::uint32_t choose(TouchedBody& body, std::span<const Candidate> found, ContactBody::StepReport& report,
                     std::uint64_t& work) {
  const auto is_left_out = [&](const Candidate& candidate, double least) {
    return is_said_by_nodes(body, candidate) || (candidate.triangle != layout::none && candidate.gap >= least);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity;  // gap from which on triangles are left out
  std::uint32_t corners = body.max_contacts + 1;
  while (corners > body.max_contacts) {
    corners = 0;
    work += found.size() * chosen_price;
    double farthest = -infinity;
    for (const Candidate& candidate : found) {
      if (is_left_out(candidate, least)) continue;
      corners += corners_of(body, candidate);
      if (candidate.triangle != layout::none) farthest = larger(farthest, candidate.gap);
    }
    if (corners > body.max_contacts) least = farthest;
  }
  std::uint32_t count = 0;
  for (const Candidate& candidate : found) {
    if (!is_left_out(candidate, least)) {
      body.candidate[count++] = candidate;
    } else if (!is_said_by_nodes(body, candidate)) {
      leave_out(candidate, 1, report);
    }
  }
  return count;
}

// copies of the tools, without what a solver needs besides, where their springs let them be
std::span<const Tool> put_tools(std::span<const ContactBody::ToolInput> tools, TouchedBody& body) {
  const std::size_t count = tools.size() < body.max_tools ? tools.size() : body.max_tools;
  for (std::size_t t = 0; t < count; ++t) {
    body.tool[t] = tools[t].tool;
    body.tool[t].pose.position += body.sag[t];
  }
  return {body.tool, count};
}

std::uint64_t most_touching_work(const TouchedBody& body, std::span<const Tool> tools) {
  const std::uint64_t contacts = body.max_contacts, whole = body.search.find_work(body.deformed, tools);
  std::uint64_t points = 0;
  for (const Tool& tool : tools) points += tool.shape.check() == Shape::Error::none ? tool.shape.point_count() : 0;
  const std::uint64_t carrying = body.carried != nullptr ? body.nodes * carried_price : 0;
  return carrying + body.deformed.update_work() + (whole < body.search_work ? whole : body.search_work) +
         tools.size() * tool_price + contacts * contact_price +
         most_choosing(contacts, CandidateSearch::most_places * points);
}

// Displacements and what the surface is carried by. False: one is not finite.
bool add_offset(const TouchedBody& body) {
  Vec4 zero;  // not a number where one was not finite
  for (std::uint32_t i = 0; i < body.nodes; ++i) {
    const Vec4 &u = body.displacement[i], &offset = body.offset[i];
    const Vec4 sum{u.x + offset.x, u.y + offset.y, u.z + offset.z, u.w + offset.w};
    body.carried[i] = sum;
    zero = {zero.x + 0 * sum.x, zero.y + 0 * sum.y, zero.z + 0 * sum.z, zero.w + 0 * sum.w};
  }
  return zero.x == 0 && zero.y == 0 && zero.z == 0 && zero.w == 0;
}

ContactBody::StepReport held(Status status) {
  ContactBody::StepReport report;
  report.status = status;
  report.error = std::numeric_limits<float>::infinity();
  return report;
}

}  // namespace

ContactBody::StepReport ContactBody::step(std::span<const ToolInput> tools, const Elastostatic::Loads& loads,
                                          Budget budget) noexcept {
  TouchedBody& body = *body_;
  if (tools.size() > body.max_tools) return held(Status::held_out_of_range);
  if (budget.work < body.least_work) return held(Status::held_over_budget);
  const bool is_carried = !body.offset.empty();
  if (is_carried && !add_offset(body)) return held(Status::held_not_finite);
  const std::span<const Tool> shapes = put_tools(tools, body);
  std::uint64_t work = tools.size() * tool_price + (is_carried ? body.nodes * carried_price : 0);
  body.deformed.update({is_carried ? body.carried : body.displacement, body.nodes}, work);
  const CandidateSearch::Found found = body.search.find(body.deformed, shapes, work, work + body.search_work);
  for (std::uint32_t t = 0; t < tools.size(); ++t) {
    body.last_placement[t] = body.placement[t];
    body.placement[t] = place(shapes[t].pose).placement;
  }
  StepReport report;
  if (found.left_out > 0) leave_out(found.deepest_left_out, found.left_out, report);
  report.unfinished = found.unfinished;
  const std::uint32_t count = choose(body, take_candidates(body, found.candidates), report, work);
  body.grips.begin_step();  // the last step may have been refused
  body.grips.begin();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Candidate& candidate = body.candidate[i];
    Grip* const grip = body.grips.find(grip_key(candidate));
    body.rest_place[i] = candidate.position - displacement_of(body, candidate.node, candidate.weight);
    body.last_place[i] = candidate.position;
    body.force_before[i] = {};
    if (grip != nullptr && grip->is_at(candidate)) {
      // the field is an approximation of it
      body.last_place[i] = body.rest_place[i] + grip->shift;
      body.force_before[i] = grip->force;
      grip->stays = true;
    }
    body.contact[i] = contact_of(body, candidate, grip, tools[candidate.tool], body.stick_place[i]);
  }
  work += count * contact_price;
  Elastostatic::UnilateralResponse response;
  response.force = {body.force, count};
  response.displacement = {body.displacement, body.nodes};
  response.state = {body.state, count};
  response.gap = {body.gap, count};
  response.yield = {body.yield, count};
  response.by_loads = {body.by_loads, count};
  static_cast<Elastostatic::UnilateralReport&>(report) = body.elastostatic.step(
      std::span<const UnilateralContact>(body.contact, count), loads, {budget.work - work}, response);
  report.touching_work = work;
  report.work += work;
  report.details.needed_work += report.details.needed_work > 0 ? work : 0;
  if (answered(report.status)) {
    let_sag(body, count, tools);
    account_energy(body, count);
    write_answer(body, count, static_cast<std::uint32_t>(tools.size()));
  }
  return report;
}

std::uint64_t ContactBody::touching_work(std::span<const ToolInput> tools) const noexcept {
  return most_touching_work(*body_, put_tools(tools, *body_));
}

const ContactBody::Energy& ContactBody::energy() const noexcept { return body_->energy; }

double ContactBody::area(const Contact& contact) const noexcept {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    if (contact.node[k] < body_->nodes) sum += contact.weight[k] * double{body_->area[contact.node[k]]};
  }
  return sum;
}

std::span<const ContactBody::ToolAnswer> ContactBody::tools() const noexcept {
  return {body_->tool_answer, body_->tool_count};
}
std::span<const ContactBody::Contact> ContactBody::contacts() const noexcept {
  return {body_->answered, body_->answered_count};
}
std::span<const Vec4> ContactBody::displacement() const noexcept { return {body_->displacement, body_->nodes}; }

void ContactBody::forget(std::uint32_t tool) noexcept {
  if (tool >= body_->max_tools) return;
  body_->search.forget(tool);
  let_go(*body_, tool);
  body_->sag[tool] = {};
}

void ContactBody::surface_friction(std::span<const float> factor) noexcept {
  if (factor.empty() || factor.size() == body_->nodes) body_->factor = factor;
}

bool ContactBody::carry(std::span<const Vec4> offset) noexcept {
  const bool fits = offset.empty() || (body_->carried != nullptr && offset.size() == body_->nodes);
  if (fits) body_->offset = offset;
  return fits;
}

const Surface& ContactBody::surface() const noexcept { return body_->surface; }

std::uint64_t ContactBody::local_model(bool turns, float length, LocalModel& model) noexcept {
  TouchedBody& body = *body_;
  return body.elastostatic.local_model({body.point, body.answered_count}, body.tool_count, turns ? 6 : 3, length,
                                       model);
}

std::uint64_t ContactBody::local_model_work(std::uint32_t tools, bool turns) const noexcept {
  return body_->elastostatic.local_model_work(body_->max_contacts, tools, turns ? 6 : 3);
}

}  // namespace greenloop
