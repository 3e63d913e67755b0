#include "runtime/contact_body.hpp"

#include <cmath>
#include <limits>
#include <new>

#include "runtime/contact_body/answer.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {
namespace {

// instructions of x86-64, for each contact and tool: from a candidate to a contact and from its answer back
constexpr std::uint64_t contact_price = 400;
constexpr std::uint64_t tool_price = 300;

double larger(double a, double b) { return a > b ? a : b; }

bool in_range(const ContactBody::Limits& limits) {
  const Elastostatic::Limits& body = limits.elastostatic;
  return limits.max_tools >= 1 && limits.max_tools <= 16 && limits.max_points >= 1 &&
         limits.max_points <= Shape::max_points && std::isfinite(limits.margin) && limits.margin >= 0 &&
         std::isfinite(limits.rigid_stiffness) && limits.rigid_stiffness >= 0 && body.iterations > 0 &&
         !body.forces_only;
}

// of all triangles of the finest level, at rest
double mean_edge(const Surface& surface, Vec4* normal) {
  const std::uint32_t level = surface.level();
  const std::uint32_t nodes = surface.node_count(level);
  auto* area = reinterpret_cast<float*>(normal);
  if (!surface.areas(level, {}, {area, nodes})) return 0;
  double sum = 0;
  for (std::uint32_t i = 0; i < nodes; ++i) sum += double{area[i]};
  constexpr double equilateral = 0.4330127018922193;  // area of a triangle with unit edges
  return std::sqrt(sum / (equilateral * surface.triangle_count(level)));
}

// memory that a part carves itself
std::span<std::byte> piece(Arena& arena, std::size_t bytes) { return {arena.take<std::byte>(bytes), bytes}; }

CandidateSearch::Limits search_limits(const ContactBody::Limits& limits, double margin) {
  return {limits.max_tools, limits.max_points, limits.elastostatic.max_contacts, margin};
}

void carve_arrays(Arena& arena, const Model& model, const ContactBody::Limits& limits, TouchedBody& body) {
  body.nodes = model.node_count();
  body.max_contacts = limits.elastostatic.max_contacts;
  body.max_tools = limits.max_tools;
  body.tool = arena.take<Tool>(limits.max_tools);
  body.placement = arena.take<Placement>(limits.max_tools);
  body.sag = arena.take_zeroed<Double3>(limits.max_tools);
  body.point = arena.take<ToolPoint>(body.max_contacts);
  body.candidate = arena.take<Candidate>(body.max_contacts);
  body.contact = arena.take<UnilateralContact>(body.max_contacts);
  body.stick_place = arena.take<Double3>(body.max_contacts);
  body.rest_place = arena.take<Double3>(body.max_contacts);
  body.last_place = arena.take<Double3>(body.max_contacts);
  body.force_before = arena.take<Vec3>(body.max_contacts);
  body.energy_contact = arena.take<EnergyContact>(std::uint64_t{2} * body.max_contacts);
  body.force = arena.take<Vec3>(body.max_contacts);
  body.gap = arena.take<Vec4>(body.max_contacts);
  body.state = arena.take<ContactState>(body.max_contacts);
  body.answered = arena.take<ContactBody::Contact>(body.max_contacts);
  body.tool_answer = arena.take<ContactBody::ToolAnswer>(limits.max_tools);
  body.displacement = arena.take_zeroed<Vec4>(body.nodes);
  body.grips.carve(arena, body.max_contacts);
}

// elastostatic_bytes: of the elastic body
bool place_parts(Arena& arena, const Model& model, const ContactBody::Limits& limits, std::size_t elastostatic_bytes,
                 TouchedBody& body) {
  const std::uint32_t finest = model.level_count() - 1;
  const auto surface = piece(arena, Surface::required(model, finest).bytes);
  const auto elastostatic = piece(arena, elastostatic_bytes);
  const auto deformed = piece(arena, DeformedSurface::required(model, finest));
  const auto search = piece(arena, CandidateSearch::required(search_limits(limits, 0)));
  if (surface.data() == nullptr) return true;  // it only counts
  const auto made_surface = Surface::create(model, finest, surface);
  const auto made_body = Elastostatic::create(model, limits.elastostatic, elastostatic);
  if (!made_surface || !made_body) return false;
  const auto made_deformed = DeformedSurface::create(made_surface.surface, deformed);
  if (!made_deformed) return false;
  body.surface = made_surface.surface;
  body.deformed = made_deformed.surface;
  body.elastostatic = made_body.body;
  body.mean_edge = mean_edge(body.surface, body.displacement);
  const double margin = limits.margin > 0 ? limits.margin : 0.25 * body.mean_edge;
  for (std::uint32_t i = 0; i < body.nodes; ++i) body.displacement[i] = {};
  const auto made_search = CandidateSearch::create(search_limits(limits, margin), search);
  if (!made_search) return false;
  body.search = made_search.search;
  return true;
}

// how much a place that cannot move gives way
float rigid_softness(const Model& model, const ContactBody::Limits& limits) {
  constexpr double depth = 1e-3;  // m
  const double stiffness = limits.rigid_stiffness > 0 ? limits.rigid_stiffness : model.view().info->young * depth;
  return static_cast<float>(1 / stiffness);
}

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

// touchable corners of a candidate; how many
std::uint32_t put_corners(const TouchedBody& body, const Candidate& candidate, UnilateralContact& contact) {
  std::uint32_t corners = 0;
  for (int k = 0; k < 3 && candidate.node[k] != layout::none; ++k) {
    const auto weight = static_cast<float>(candidate.weight[k]);
    if (weight > 0 && body.deformed.is_touchable(candidate.node[k])) {
      contact.node[corners] = candidate.node[k];
      contact.weight[corners++] = weight;
    }
  }
  return corners;
}

// where a contact's point has to go to stand on the tool where it touched it, without slipping, from where it is
Double3 way_to_stick(const Candidate& candidate, const Placement& placement, const Grip* grip) {
  const Double3& n = candidate.normal;
  const Double3 out = -candidate.gap * n;
  if (grip == nullptr || !grip->touches) return out;
  const Double3 way = placement.to_model(grip->anchor) - candidate.position;
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
  const Double3 way = way_to_stick(candidate, body.placement[candidate.tool], grip);
  stick_place = candidate.position + way;
  put(contact.value, pushed_displacement(body, candidate) + way - body.sag[candidate.tool]);
  put(contact.normal, candidate.normal);
  contact.friction = static_cast<float>(tool.friction * friction_factor(body, candidate));
  contact.tool = candidate.tool;
  contact.mount = static_cast<float>(tool.compliance);
  contact.softness = corners > 0 ? 0 : body.rigid_softness;
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

// the candidates that there is room for, by their corners: while there is none, those of triangles farthest from the
// tool are left out, which hang on nodes that may be candidates themselves
std::uint32_t choose(TouchedBody& body, std::span<const Candidate> found, ContactBody::StepReport& report) {
  const auto is_left_out = [&](const Candidate& candidate, double least) {
    return is_said_by_nodes(body, candidate) || (candidate.triangle != layout::none && candidate.gap >= least);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity;  // gap from which on triangles are left out
  std::uint32_t corners = body.max_contacts + 1;
  while (corners > body.max_contacts) {
    corners = 0;
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
      ++report.left_out;
      report.deepest_left_out = larger(report.deepest_left_out, -candidate.gap);
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

// what choose takes, if every pass leaves one out
std::uint64_t most_choosing(std::uint64_t contacts) { return contacts * contacts * 8; }

std::uint64_t most_touching_work(const TouchedBody& body, std::span<const Tool> tools) {
  const std::uint64_t contacts = body.max_contacts;
  return body.deformed.update_work() + body.search.find_work(body.deformed, tools) + tools.size() * tool_price +
         contacts * contact_price + most_choosing(contacts);
}

// why limits have no requirement
CreateError refusal(const Model& model, const ContactBody::Limits& limits) {
  if (!in_range(limits)) return CreateError::bad_limits;
  const CreateError error = Elastostatic::create(model, limits.elastostatic, {}).error;
  return error == CreateError::bad_limits ? error : CreateError::unsupported_model;
}

// bytes of all, given what the elastic body needs
std::size_t bytes_of(const Model& model, const ContactBody::Limits& limits, std::size_t elastostatic_bytes) {
  Arena counting;
  TouchedBody body;
  static_cast<void>(counting.take<TouchedBody>(1));
  carve_arrays(counting, model, limits, body);
  place_parts(counting, model, limits, elastostatic_bytes, body);
  return static_cast<std::size_t>(counting.bytes());
}

ContactBody::StepReport held(Status status) {
  ContactBody::StepReport report;
  report.status = status;
  report.error = std::numeric_limits<float>::infinity();
  return report;
}

}  // namespace

ContactBody::Requirement ContactBody::required(const Model& model, const Limits& limits) noexcept {
  if (!in_range(limits)) return {};
  const Elastostatic::Requirement elastostatic = Elastostatic::required(model, limits.elastostatic);
  if (elastostatic.bytes == 0) return {};
  Requirement requirement;
  requirement.bytes = bytes_of(model, limits, elastostatic.bytes);
  requirement.least_work = elastostatic.least_work;
  requirement.worst_work = elastostatic.worst_work[model.level_count() - 1];
  return requirement;
}

ContactBody::Created ContactBody::create(const Model& model, const Limits& limits,
                                         std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  const Elastostatic::Requirement elastostatic =
      in_range(limits) ? Elastostatic::required(model, limits.elastostatic) : Elastostatic::Requirement{};
  created.requested = elastostatic.bytes > 0 ? bytes_of(model, limits, elastostatic.bytes) : 0;
  if (created.requested == 0) {
    created.error = refusal(model, limits);
    return created;
  }
  if (created.requested > memory.size()) {
    created.error = CreateError::arena_too_small;
    created.missing = created.requested - memory.size();
    return created;
  }
  if (reinterpret_cast<std::uintptr_t>(memory.data()) % Arena::alignment != 0) {
    created.error = CreateError::arena_misaligned;
    return created;
  }
  Arena arena(memory.data());
  auto& body = *new (arena.take<TouchedBody>(1)) TouchedBody;
  carve_arrays(arena, model, limits, body);
  if (!place_parts(arena, model, limits, elastostatic.bytes, body)) {
    created.error = CreateError::unsupported_model;
    return created;
  }
  body.rigid_softness = rigid_softness(model, limits);
  body.least_work = elastostatic.least_work;
  created.body.body_ = &body;
  return created;
}

ContactBody::StepReport ContactBody::step(std::span<const ToolInput> tools, const Elastostatic::Loads& loads,
                                          Budget budget) noexcept {
  TouchedBody& body = *body_;
  if (tools.size() > body.max_tools) return held(Status::held_out_of_range);
  if (budget.work < body.least_work) return held(Status::held_over_budget);
  const std::span<const Tool> shapes = put_tools(tools, body);
  std::uint64_t work = tools.size() * tool_price;
  body.deformed.update({body.displacement, body.nodes}, work);
  const CandidateSearch::Found found = body.search.find(body.deformed, shapes, work);
  for (std::uint32_t t = 0; t < tools.size(); ++t) body.placement[t] = place(shapes[t].pose).placement;
  StepReport report;
  report.left_out = found.left_out;
  report.deepest_left_out = found.left_out > 0 ? -found.deepest_left_out.gap : 0;
  const std::uint32_t count = choose(body, take_candidates(body, found.candidates), report);
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
  static_cast<Elastostatic::UnilateralReport&>(report) =
      body.elastostatic.step(std::span<const UnilateralContact>(body.contact, count), loads, budget, response);
  report.touching_work = work;
  if (answered(report.status)) {
    let_sag(body, count, tools);
    account_energy(body, count);
    write_answer(body, count, tools);
  }
  return report;
}

std::uint64_t ContactBody::touching_work(std::span<const ToolInput> tools) const noexcept {
  return most_touching_work(*body_, put_tools(tools, *body_));
}

const ContactBody::Energy& ContactBody::energy() const noexcept { return body_->energy; }

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
  body_->grips.forget(tool);
  body_->sag[tool] = {};
}

void ContactBody::surface_friction(std::span<const float> factor) noexcept {
  if (factor.empty() || factor.size() == body_->nodes) body_->factor = factor;
}

std::uint64_t ContactBody::local_model(bool turns, float length, LocalModel& model) noexcept {
  TouchedBody& body = *body_;
  return body.elastostatic.local_model({body.point, body.answered_count}, body.tool_count, turns ? 6 : 3, length,
                                       model);
}

std::uint64_t ContactBody::local_model_work(std::uint32_t tools, bool turns) const noexcept {
  return Elastostatic::local_model_work(body_->max_contacts, tools, turns ? 6 : 3);
}

}  // namespace greenloop
