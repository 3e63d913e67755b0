#include "runtime/vibrating_body.hpp"

#include <new>

#include "runtime/memory/arena.hpp"
#include "runtime/memory/fit.hpp"

namespace greenloop {

struct VibratingParts {
  ContactBody contact;
  ImpulseResponse motion;
  std::uint32_t nodes = 0, vertices = 0;
  std::uint64_t motion_work = 0;       ///< units of a step with all modes
  std::uint64_t contact_work = 0;      ///< units that contacts keep
  std::uint64_t least_work = 0;        ///< units of a step
  std::uint32_t* vertex_of = nullptr;  ///< [nodes]
  Vec3* at_rest = nullptr;             ///< [vertices] m, from the motions' shape, which is their mean
  Vec3* moved = nullptr;               ///< [vertices] m, of the last motion
  Vec4* offset = nullptr;              ///< [nodes] m, the same
  Vec4* displacement = nullptr;        ///< [nodes] m, of both
};

namespace {

// instructions of x86-64, for each node: from its vertex to its offset, and the sum of both displacements
constexpr std::uint64_t node_price = 26;

struct Needs {
  ContactBody::Requirement contact;
  ImpulseResponse::Requirement motion;
};

ContactBody::Limits carried(ContactBody::Limits limits) {
  limits.carried = true;
  return limits;
}

Needs needs_of(const Model& touched, const Model& moving, const VibratingBody::Limits& limits) {
  return {ContactBody::required(touched, carried(limits.contact)), ImpulseResponse::required(moving, limits.motion)};
}

struct Pieces {
  std::span<std::byte> contact, motion;
};

Pieces carve(Arena& arena, const Needs& needs, VibratingParts& parts) {
  parts.vertex_of = arena.take<std::uint32_t>(parts.nodes);
  parts.at_rest = arena.take<Vec3>(parts.vertices);
  parts.moved = arena.take<Vec3>(parts.vertices);
  parts.offset = arena.take_zeroed<Vec4>(parts.nodes);
  parts.displacement = arena.take_zeroed<Vec4>(parts.nodes);
  return {{arena.take<std::byte>(needs.contact.bytes), needs.contact.bytes},
          {arena.take<std::byte>(needs.motion.bytes), needs.motion.bytes}};
}

VibratingParts sized_parts(const Model& touched, const Model& moving) {
  VibratingParts parts;
  parts.nodes = touched.node_count();
  parts.vertices = moving.view().impulse_response.info->vertices;
  return parts;
}

VibratingBody::Requirement requirement_of(const Model& touched, const Model& moving, const Needs& needs) {
  if (needs.contact.bytes == 0 || needs.motion.bytes == 0) return {};
  VibratingParts parts = sized_parts(touched, moving);
  Arena counting;
  static_cast<void>(counting.take<VibratingParts>(1));
  carve(counting, needs, parts);
  const std::uint64_t carrying = parts.nodes * node_price;
  VibratingBody::Requirement requirement;
  requirement.bytes = static_cast<std::size_t>(counting.bytes());
  requirement.least_work = needs.motion.least_frame_work + carrying + needs.contact.least_work;
  requirement.worst_work = needs.motion.frame_work + carrying + needs.contact.worst_work;
  return requirement;
}

// m^2, how far two places that are the same may be apart in two files: one has left out modes
double same_place(const layout::Info& info) {
  constexpr double share = 1e-3;  // of the diagonal
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double side = double{info.box_max[i]} - double{info.box_min[i]};
    sum += side * side;
  }
  return share * share * sum;
}

// the vertex at the place of each node; false: one has none
bool match(const Surface& surface, const layout::Info& info, const ImpulseResponseView& moving, const Vec3* at_rest,
           std::span<std::uint32_t> vertex_of) {
  for (std::uint32_t& vertex : vertex_of) vertex = layout::none;
  const double most = same_place(info);
  for (std::uint32_t v = 0; v < moving.info->vertices; ++v) {
    const float* const x = moving.shape + std::size_t{3} * v;
    const Vec3& u = at_rest[v];
    const Surface::NearestNode nearest = surface.nearest_node({x[0] + u.x, x[1] + u.y, x[2] + u.z});
    if (nearest.node != layout::none && nearest.squared_distance <= most) vertex_of[nearest.node] = v;
  }
  for (const std::uint32_t vertex : vertex_of) {
    if (vertex == layout::none) return false;
  }
  return true;
}

CreateError make_bodies(const Model& touched, const Model& moving, const VibratingBody::Limits& limits,
                        const Pieces& pieces, VibratingParts& parts) {
  const auto contact = ContactBody::create(touched, carried(limits.contact), pieces.contact);
  if (!contact) return contact.error;
  const auto motion = ImpulseResponse::create(moving, limits.motion, pieces.motion);
  if (!motion) return motion.error;
  parts.contact = contact.body;
  parts.motion = motion.body;
  return CreateError::none;
}

void gather_offset(const VibratingParts& parts) {
  for (std::uint32_t i = 0; i < parts.nodes; ++i) {
    const Vec3 &moved = parts.moved[parts.vertex_of[i]], &rest = parts.at_rest[parts.vertex_of[i]];
    parts.offset[i] = {moved.x - rest.x, moved.y - rest.y, moved.z - rest.z, 0};
  }
}

void add_displacements(const VibratingParts& parts) {
  const std::span<const Vec4> elastic = parts.contact.displacement();
  for (std::uint32_t i = 0; i < parts.nodes; ++i) {
    const Vec4 &u = elastic[i], &offset = parts.offset[i];
    parts.displacement[i] = {u.x + offset.x, u.y + offset.y, u.z + offset.z, 0};
  }
}

}  // namespace

VibratingBody::Requirement VibratingBody::required(const Model& touched, const Model& moving,
                                                   const Limits& limits) noexcept {
  return requirement_of(touched, moving, needs_of(touched, moving, limits));
}

VibratingBody::Created VibratingBody::create(const Model& touched, const Model& moving, const Limits& limits,
                                             std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  const Needs needs = needs_of(touched, moving, limits);
  const Requirement requirement = requirement_of(touched, moving, needs);
  created.requested = requirement.bytes;
  if (created.requested == 0) {
    created.error = needs.contact.bytes == 0 ? ContactBody::create(touched, carried(limits.contact), {}).error
                                             : ImpulseResponse::create(moving, limits.motion, {}).error;
    return created;
  }
  if (!memory_fits(memory, CreateError::arena_too_small, CreateError::arena_misaligned, created)) return created;
  Arena arena(memory.data());
  auto& parts = *new (arena.take<VibratingParts>(1)) VibratingParts(sized_parts(touched, moving));
  const Pieces pieces = carve(arena, needs, parts);
  created.error = make_bodies(touched, moving, limits, pieces, parts);
  if (!created) return created;
  ImpulseResponse::Response response;
  response.displacement = {parts.at_rest, parts.vertices};
  parts.motion.step(ImpulseResponse::no_impulse, {needs.motion.frame_work}, response);  // it stays at rest
  if (!match(parts.contact.surface(), *touched.view().info, moving.view().impulse_response, parts.at_rest,
             {parts.vertex_of, parts.nodes})) {
    created.error = CreateError::mismatched_models;
    return created;
  }
  if (!parts.contact.carry({parts.offset, parts.nodes})) {
    created.error = CreateError::bad_limits;
    return created;
  }
  parts.motion_work = needs.motion.frame_work;
  parts.contact_work = needs.contact.least_work;
  parts.least_work = requirement.least_work;
  created.body.parts_ = &parts;
  return created;
}

VibratingBody::StepReport VibratingBody::step(std::uint32_t impulse, std::span<const ContactBody::ToolInput> tools,
                                              const Elastostatic::Loads& loads, Budget budget) noexcept {
  VibratingParts& parts = *parts_;
  StepReport report;
  if (budget.work < parts.least_work) {
    report.motion.status = report.contact.status = Status::held_over_budget;
    return report;
  }
  const std::uint64_t carrying = parts.nodes * node_price, spare = budget.work - carrying - parts.contact_work;
  const std::uint64_t motion_work = spare < parts.motion_work ? spare : parts.motion_work;
  ImpulseResponse::Response response;
  response.displacement = {parts.moved, parts.vertices};
  report.motion = parts.motion.step(impulse, {motion_work}, response);
  if (answered(report.motion.status)) gather_offset(parts);
  report.contact = parts.contact.step(tools, loads, {budget.work - carrying - report.motion.work});
  add_displacements(parts);
  report.work = carrying + report.motion.work + report.contact.work;
  return report;
}

ContactBody& VibratingBody::contact() noexcept { return parts_->contact; }
const ImpulseResponse& VibratingBody::motion() const noexcept { return parts_->motion; }
std::span<const Vec4> VibratingBody::offset() const noexcept { return {parts_->offset, parts_->nodes}; }
std::span<const Vec4> VibratingBody::displacement() const noexcept { return {parts_->displacement, parts_->nodes}; }

}  // namespace greenloop
