#include "runtime/contact_body/answer.hpp"

namespace greenloop {
namespace {

double larger(double a, double b) { return a > b ? a : b; }

Vec4 narrow(const Double3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0}; }

Double3 double3(const Vec3& v) { return {v.x, v.y, v.z}; }
Double3 double3(const Vec4& v) { return {v.x, v.y, v.z}; }

// where a contact's point has come to: from where it would stick, if it has slipped or the tool has left it
Double3 place_after(const TouchedBody& body, std::uint32_t i) { return body.stick_place[i] + double3(body.gap[i]); }

// a contact that waits for the factor: nothing is known of it
bool waits(const TouchedBody& body, std::uint32_t i) {
  const Vec4& gap = body.gap[i];
  return body.state[i] == ContactState::open && gap.x == 0 && gap.y == 0 && gap.z == 0;
}

void remember(TouchedBody& body, std::uint32_t i, const Double3& place, const Grip* grip) {
  const Candidate& candidate = body.candidate[i];
  Grip made;
  made.key = grip_key(candidate);
  made.touches = body.state[i] != ContactState::open;
  made.sticks = body.state[i] == ContactState::stick;
  const bool holds_on = grip != nullptr && grip->touches && made.sticks;
  made.anchor = holds_on ? grip->anchor : body.placement[candidate.tool].to_tool(place);
  made.force = body.force[i];
  made.by_loads = body.by_loads[i];
  made.shift = waits(body, i) ? body.last_place[i] - body.rest_place[i] : place - body.rest_place[i];
  for (int k = 0; k < 3; ++k) {
    made.node[k] = candidate.node[k];
    made.weight[k] = candidate.weight[k];
  }
  body.grips.add(made);
}

// how far contacts push the nodes of a place
void hold_out(TouchedBody& body, const std::uint32_t (&node)[3], float yield) {
  for (int k = 0; k < 3 && node[k] != layout::none; ++k) body.held_out[node[k]] = yield;
}

// of this answer's contacts instead of the last one's
void remember_pushed(TouchedBody& body, std::uint32_t count) {
  for (const Grip& grip : body.grips.all()) hold_out(body, grip.node, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (body.yield[i] > 0) hold_out(body, body.candidate[i].node, body.yield[i]);
  }
}

bool is_behind(const TouchedBody& body, std::uint32_t tool) {
  bool behind = false;
  const std::uint32_t points = body.search.fault(tool) == ToolFault::none ? body.tool[tool].shape.point_count() : 0;
  for (std::uint32_t i = 0; i < points; ++i) {
    behind = behind || body.search.proxy(tool, i).is_held();
  }
  return behind;
}

ContactBody::Contact contact_after(const TouchedBody& body, std::uint32_t i, const Double3& place) {
  const Candidate& candidate = body.candidate[i];
  ContactBody::Contact contact;
  for (int k = 0; k < 3; ++k) {
    contact.node[k] = candidate.node[k];
    contact.weight[k] = candidate.weight[k];
  }
  contact.tool = candidate.tool;
  contact.state = body.state[i];
  contact.position = place;
  contact.normal = candidate.normal;
  contact.force = double3(body.force[i]);
  const Double3 from_stick = double3(body.gap[i]);
  contact.gap = dot(candidate.normal, from_stick);
  contact.slip = contact.state == ContactState::open ? Double3{} : from_stick - contact.gap * candidate.normal;
  return contact;
}

// of a tool, whose contacts are those from `next` on; which is then the next tool's
void write_tool(TouchedBody& body, std::uint32_t count, std::uint32_t tool, std::uint32_t& next) {
  ContactBody::ToolAnswer& answer = body.tool_answer[tool];
  answer = {};
  answer.fault = body.search.fault(tool);
  answer.is_behind = is_behind(body, tool);
  answer.sag = body.sag[tool];
  answer.first_contact = next;
  for (; next < count && body.candidate[next].tool == tool; ++next) {
    const Candidate& candidate = body.candidate[next];
    const Double3 place = place_after(body, next);
    remember(body, next, place, body.grips.find(grip_key(candidate)));
    body.answered[next] = contact_after(body, next, place);
    const Double3 force = body.answered[next].force;
    const Double3 lever = place - body.placement[tool].origin;
    body.point[next] = {tool, narrow(lever)};
    ++answer.contacts;
    answer.depth = larger(answer.depth, -candidate.gap);
    answer.force += -force;
    answer.torque += cross(lever, -force);
  }
}

}  // namespace

Double3 displacement_of(const TouchedBody& body, const std::uint32_t (&node)[3], const double (&weight)[3]) noexcept {
  Double3 sum;
  for (int k = 0; k < 3 && node[k] != layout::none; ++k) {
    sum += weight[k] * double3(body.displacement[node[k]]);
  }
  return sum;
}

void let_sag(TouchedBody& body, std::uint32_t count, std::span<const ContactBody::ToolInput> tools) noexcept {
  for (std::uint32_t t = 0, i = 0; t < tools.size(); ++t) {
    Double3 force;
    std::uint32_t end = i;
    for (; end < count && body.candidate[end].tool == t; ++end) force += -double3(body.force[end]);
    const Double3 sag = dot(force, force) > 0 ? tools[t].compliance * force : Double3{};
    const Double3 further = sag - body.sag[t];
    for (; i < end; ++i) body.stick_place[i] += further;
    body.placement[t].origin += further;
    body.sag[t] = sag;
  }
}

void account_energy(TouchedBody& body, std::uint32_t count) noexcept {
  std::uint32_t last = 0;
  for (const Grip& grip : body.grips.all()) {
    if (grip.stays || !grip.touches) continue;
    EnergyContact& contact = body.energy_contact[last++];
    contact = {};
    contact.last_force = double3(grip.force);
    contact.last_shift = grip.shift;
    contact.shift = displacement_of(body, grip.node, grip.weight);
  }
  body.grips.begin();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Grip* const grip = body.grips.find(grip_key(body.candidate[i]));
    EnergyContact& contact = body.energy_contact[last++];
    contact.normal = body.candidate[i].normal;
    contact.force = double3(body.force[i]);
    contact.last_force = double3(body.force_before[i]);
    contact.shift = place_after(body, i) - body.rest_place[i];
    contact.last_shift = body.last_place[i] - body.rest_place[i];
    const Vec4 loaded_before = grip != nullptr && grip->stays ? grip->by_loads : body.by_loads[i];
    if (waits(body, i)) body.by_loads[i] = loaded_before;
    contact.by_loads = double3(body.by_loads[i]);
    contact.last_by_loads = double3(loaded_before);
    contact.way = body.stick_place[i] - body.last_place[i];
  }
  EnergyAccount& account = body.account;
  account.add({body.energy_contact, last});
  const double generated = larger(body.energy.generated, account.generated());
  body.energy = {account.in, account.stored, account.dissipated, account.lost, generated, account.from_loads};
}

void let_go(TouchedBody& body, std::uint32_t tool) noexcept {
  for (const Grip& grip : body.grips.all()) {
    if (tool_of_key(grip.key) == tool) hold_out(body, grip.node, 0);
  }
  body.grips.forget(tool);
}

void write_answer(TouchedBody& body, std::uint32_t count, std::uint32_t tools) noexcept {
  remember_pushed(body, count);
  body.tool_count = tools;
  body.answered_count = count;
  body.grips.begin();
  const auto shift_of = [&](const Grip& grip) { return displacement_of(body, grip.node, grip.weight); };
  std::uint32_t next = 0;
  for (std::uint32_t t = 0; t < tools; ++t) {
    write_tool(body, count, t, next);
    // a tool that is left out holds on to what it held, if what others hold leaves room for it
    if (body.tool_answer[t].fault != ToolFault::none) {
      body.grips.keep(t, body.max_contacts - (count - next), shift_of);
    }
  }
  for (std::uint32_t t = tools; t < body.max_tools; ++t) body.grips.keep(t, body.max_contacts, shift_of);
  body.grips.turn();
}

}  // namespace greenloop
