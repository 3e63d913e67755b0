// Unilateral contacts and rigid tools in C.
#include <bit>
#include <cstddef>
#include <new>
#include <type_traits>

#include "runtime/c_body_values.hpp"
#include "runtime/c_values.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/greenloop_contact.h"

namespace greenloop {
namespace {

// NOLINTBEGIN(misc-redundant-expression): two types are compared
static_assert(sizeof(UnilateralContact) == sizeof(greenloop_unilateral_contact) &&
              offsetof(UnilateralContact, weight) == offsetof(greenloop_unilateral_contact, weight) &&
              offsetof(UnilateralContact, friction) == offsetof(greenloop_unilateral_contact, friction) &&
              offsetof(UnilateralContact, force) == offsetof(greenloop_unilateral_contact, force) &&
              offsetof(UnilateralContact, mount) == offsetof(greenloop_unilateral_contact, mount) &&
              UnilateralContact::none == GREENLOOP_NONE);
static_assert(sizeof(ContactState) == sizeof(std::uint8_t) && same(GREENLOOP_CONTACT_OPEN, ContactState::open) &&
              same(GREENLOOP_CONTACT_STICK, ContactState::stick) && same(GREENLOOP_CONTACT_SLIP, ContactState::slip));
static_assert(sizeof(ContactBody::ToolAnswer) == sizeof(greenloop_tool_answer) &&
              offsetof(ContactBody::ToolAnswer, force) == offsetof(greenloop_tool_answer, force) &&
              offsetof(ContactBody::ToolAnswer, first_contact) == offsetof(greenloop_tool_answer, first_contact) &&
              offsetof(ContactBody::ToolAnswer, depth) == offsetof(greenloop_tool_answer, depth) &&
              offsetof(ContactBody::ToolAnswer, sag) == offsetof(greenloop_tool_answer, sag));
static_assert(sizeof(LocalModel) == sizeof(greenloop_local_model) &&
              offsetof(LocalModel, change) == offsetof(greenloop_local_model, change) &&
              LocalModel::most_tools == static_cast<int>(GREENLOOP_LOCAL_TOOLS) &&
              LocalModel::most_components == static_cast<int>(GREENLOOP_LOCAL_COMPONENTS));
static_assert(sizeof(ContactBody::Contact) == sizeof(greenloop_touch) &&
              offsetof(ContactBody::Contact, weight) == offsetof(greenloop_touch, weight) &&
              offsetof(ContactBody::Contact, state) == offsetof(greenloop_touch, state) &&
              offsetof(ContactBody::Contact, position) == offsetof(greenloop_touch, position) &&
              offsetof(ContactBody::Contact, force) == offsetof(greenloop_touch, force) &&
              offsetof(ContactBody::Contact, gap) == offsetof(greenloop_touch, gap));
static_assert(sizeof(Double3) == 3 * sizeof(double) && sizeof(ConvexPolyhedron::Face) == 3 * sizeof(std::uint32_t));
static_assert(sizeof(ContactBody) == sizeof(void*) && std::is_trivially_copyable_v<ContactBody>);
// NOLINTEND(misc-redundant-expression)
static_assert(same(GREENLOOP_TOOL_BAD_SHAPE, ToolFault::bad_shape) &&
              same(GREENLOOP_TOOL_TOO_MANY_POINTS, ToolFault::too_many_points) &&
              same(GREENLOOP_TOOL_NOT_FINITE, ToolFault::not_finite) &&
              same(GREENLOOP_TOOL_TOO_FAR, ToolFault::too_far) && same(GREENLOOP_TOOL_NOT_UNIT, ToolFault::not_unit));
using PolyhedronError = ConvexPolyhedron::Error;
static_assert(same(GREENLOOP_POLYHEDRON_BAD_COUNT, PolyhedronError::bad_count) &&
              same(GREENLOOP_POLYHEDRON_NOT_FINITE, PolyhedronError::not_finite) &&
              same(GREENLOOP_POLYHEDRON_BAD_INDEX, PolyhedronError::bad_index) &&
              same(GREENLOOP_POLYHEDRON_FLAT_FACE, PolyhedronError::flat_face) &&
              same(GREENLOOP_POLYHEDRON_NOT_CLOSED, PolyhedronError::not_closed) &&
              same(GREENLOOP_POLYHEDRON_INWARD, PolyhedronError::inward) &&
              same(GREENLOOP_POLYHEDRON_NOT_CONVEX, PolyhedronError::not_convex) &&
              same(GREENLOOP_POLYHEDRON_MEMORY_TOO_SMALL, PolyhedronError::memory_too_small) &&
              same(GREENLOOP_POLYHEDRON_MEMORY_MISALIGNED, PolyhedronError::memory_misaligned));

// a polyhedron stands before its vertices and faces
constexpr std::size_t head = GREENLOOP_ALIGNMENT;
static_assert(sizeof(ConvexPolyhedron) <= head && std::is_trivially_destructible_v<ConvexPolyhedron>);

const ConvexPolyhedron& polyhedron_in(const greenloop_polyhedron* polyhedron) {
  return *std::launder(reinterpret_cast<const ConvexPolyhedron*>(polyhedron));
}

Shape shape_of(const greenloop_shape& shape) {
  const double* const size = shape.size;
  switch (shape.kind) {
    case GREENLOOP_SHAPE_POINT:
      return {};
    case GREENLOOP_SHAPE_SPHERE:
      return Shape::sphere(size[0]);
    case GREENLOOP_SHAPE_CAPSULE:
      return Shape::capsule(size[0], size[1]);
    case GREENLOOP_SHAPE_BOX:
      return Shape::box({size[0], size[1], size[2]});
    case GREENLOOP_SHAPE_PLANE:
      return Shape::plane();
    case GREENLOOP_SHAPE_POLYHEDRON:
      if (shape.polyhedron != nullptr) return Shape::polyhedron(polyhedron_in(shape.polyhedron));
      break;
  }
  return Shape::polyhedron({});
}

ContactBody touched_in(const greenloop_contact_body* body) {
  return std::bit_cast<ContactBody>(reinterpret_cast<const TouchedBody*>(body));
}

const LocalModel& model_at(const greenloop_local_model* model) {
  return *std::launder(reinterpret_cast<const LocalModel*>(model));
}

greenloop_unilateral_report push_report_of(const Elastostatic::UnilateralReport& report) {
  return {report_of(static_cast<const Elastostatic::StepReport&>(report)), report.residual, report.iterations};
}

constexpr const char* polyhedron_error_texts[] = {
    "the polyhedron was created",
    "fewer than 4 vertices or faces, or more than 128 vertices or 252 faces",
    "a vertex is not finite, or a coordinate of more than 1e6 m",
    "a face names a vertex that is not there",
    "a face has no area",
    "the surface is not closed: an edge is not that of two faces that run along it in opposite directions",
    "faces are clockwise seen from outside, or enclose nothing",
    "a vertex stands out from a face's plane: the polyhedron is not convex",
    "the memory is too small: give it as many bytes as were requested",
    "the memory is not 64-byte aligned",
};

constexpr const char* tool_fault_texts[] = {
    "the tool is answered",
    "left out: a size of its shape is not finite, too small or above 1e6 m, or it is no polyhedron that was created",
    "left out: its shape has more points than the limits allow",
    "left out: its pose is NaN or infinite",
    "left out: a coordinate of its position is above 1e6 m",
    "left out: its quaternion is not of unit length",
};

}  // namespace

ContactBody::ToolInput tool_of(const greenloop_tool& tool) noexcept {
  const double *const x = tool.position, *const q = tool.quaternion;
  return {{shape_of(tool.shape), {{x[0], x[1], x[2]}, {q[0], q[1], q[2], q[3]}}}, tool.friction, tool.compliance};
}

ContactBody::Limits touched_limits_of(const greenloop_contact_body_limits& limits) noexcept {
  ContactBody::Limits same;
  same.elastostatic = limits_of(limits.elastostatic);
  same.max_tools = limits.max_tools == 0 ? same.max_tools : limits.max_tools;
  same.max_points = limits.max_points == 0 ? same.max_points : limits.max_points;
  same.margin = limits.margin;
  same.rigid_stiffness = limits.rigid_stiffness;
  same.search_work = limits.search_work;
  same.carried = limits.carried != 0;
  return same;
}

Elastostatic::Loads acting(const greenloop_loads* loads) noexcept {
  return loads == nullptr ? Elastostatic::Loads{} : loads_of(*loads);
}

greenloop_contact_body_report touch_report_of(const ContactBody::StepReport& report) noexcept {
  const ContactBody::Place& place = report.left_out_place;
  return {push_report_of(static_cast<const Elastostatic::UnilateralReport&>(report)),
          report.touching_work,
          report.left_out,
          report.deepest_left_out,
          place.tool,
          {place.node[0], place.node[1], place.node[2]},
          {place.weight[0], place.weight[1], place.weight[2]},
          report.unfinished};
}

}  // namespace greenloop

using namespace greenloop;

greenloop_unilateral_report greenloop_elastostatic_push(greenloop_elastostatic* body,
                                                        const greenloop_unilateral_contact* contacts, size_t count,
                                                        const greenloop_loads* loads, uint64_t work, float* force,
                                                        uint8_t* state, float* gap, float* displacement,
                                                        uint32_t nodes) {
  Elastostatic::UnilateralResponse response;
  static_cast<Elastostatic::Response&>(response) = response_of(count, force, displacement, nodes);
  response.state = {reinterpret_cast<ContactState*>(state), state == nullptr ? 0 : count};
  response.gap = {reinterpret_cast<Vec4*>(gap), gap == nullptr ? 0 : count};
  const std::span<const UnilateralContact> same(reinterpret_cast<const UnilateralContact*>(contacts), count);
  return push_report_of(body_in(body).step(same, acting(loads), {work}, response));
}

size_t greenloop_polyhedron_required(size_t vertices, size_t faces) {
  return head + ConvexPolyhedron::required(vertices, faces);
}

greenloop_polyhedron_created greenloop_polyhedron_create(const double* vertex, size_t vertices, const uint32_t* face,
                                                         size_t faces, void* memory, size_t bytes) {
  auto* const at = static_cast<std::byte*>(memory);
  const std::size_t rest = bytes < head ? 0 : bytes - head;
  const auto created = ConvexPolyhedron::create({reinterpret_cast<const Double3*>(vertex), vertices},
                                                {reinterpret_cast<const ConvexPolyhedron::Face*>(face), faces},
                                                {bytes < head ? at : at + head, rest});
  greenloop_polyhedron_created same = {static_cast<greenloop_polyhedron_error>(created.error),
                                       created.at,
                                       created.requested + head,
                                       bytes,
                                       created.requested + head > bytes ? created.requested + head - bytes : 0,
                                       nullptr};
  if (created) same.polyhedron = reinterpret_cast<greenloop_polyhedron*>(new (at) ConvexPolyhedron(created.polyhedron));
  return same;
}

greenloop_contact_body_requirement greenloop_contact_body_required(const greenloop_model* model,
                                                                   greenloop_contact_body_limits limits) {
  const ContactBody::Requirement need = ContactBody::required(model_in(model), touched_limits_of(limits));
  return {need.bytes, need.least_work, need.worst_work, need.touching_work};
}

greenloop_contact_body_created greenloop_contact_body_create(const greenloop_model* model,
                                                             greenloop_contact_body_limits limits, void* memory,
                                                             size_t bytes) {
  const auto created =
      ContactBody::create(model_in(model), touched_limits_of(limits), {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_contact_body*>(std::bit_cast<TouchedBody*>(created.body))};
}

uint64_t greenloop_contact_body_touching_work(const greenloop_contact_body* body, const greenloop_tool* tools,
                                              size_t count) {
  return touched_in(body).touching_work(Tools(tools, count).all());
}

greenloop_contact_body_report greenloop_contact_body_step(greenloop_contact_body* body, const greenloop_tool* tools,
                                                          size_t count, const greenloop_loads* loads, uint64_t work) {
  const ContactBody::StepReport report = touched_in(body).step(Tools(tools, count).all(), acting(loads), {work});
  return touch_report_of(report);
}

const greenloop_tool_answer* greenloop_contact_body_tools(const greenloop_contact_body* body, size_t* count) {
  const auto answers = touched_in(body).tools();
  *count = answers.size();
  return reinterpret_cast<const greenloop_tool_answer*>(answers.data());
}

const greenloop_touch* greenloop_contact_body_contacts(const greenloop_contact_body* body, size_t* count) {
  const auto contacts = touched_in(body).contacts();
  *count = contacts.size();
  return reinterpret_cast<const greenloop_touch*>(contacts.data());
}

greenloop_contact_energy greenloop_contact_body_energy(const greenloop_contact_body* body) {
  const ContactBody::Energy& energy = touched_in(body).energy();
  return {energy.in, energy.stored, energy.dissipated, energy.lost, energy.generated, energy.from_loads};
}

double greenloop_contact_body_area(const greenloop_contact_body* body, const greenloop_touch* touch) {
  return touched_in(body).area(*reinterpret_cast<const ContactBody::Contact*>(touch));
}

const float* greenloop_contact_body_displacement(const greenloop_contact_body* body, size_t* nodes) {
  const auto field = touched_in(body).displacement();
  *nodes = field.size();
  return reinterpret_cast<const float*>(field.data());
}

void greenloop_contact_body_forget(greenloop_contact_body* body, uint32_t tool) { touched_in(body).forget(tool); }

void greenloop_contact_body_surface_friction(greenloop_contact_body* body, const float* factor, size_t nodes) {
  touched_in(body).surface_friction({factor, factor == nullptr ? 0 : nodes});
}

int greenloop_contact_body_carry(greenloop_contact_body* body, const float* offset, size_t nodes) {
  const auto* const first = reinterpret_cast<const Vec4*>(offset);
  return touched_in(body).carry({first, offset == nullptr ? 0 : nodes}) ? 1 : 0;
}

uint64_t greenloop_contact_body_local_model(greenloop_contact_body* body, uint8_t turns, float length,
                                            greenloop_local_model* model) {
  return touched_in(body).local_model(turns != 0, length, *std::launder(reinterpret_cast<LocalModel*>(model)));
}

float greenloop_local_model_motion_length(const greenloop_local_model* model, const float* motion) {
  return model_at(model).motion_length({motion, std::size_t{model->components} * model->tools});
}

void greenloop_local_model_evaluate(const greenloop_local_model* model, const float* motion, float* wrenches) {
  model_at(model).evaluate({motion, std::size_t{model->components} * model->tools},
                           {wrenches, std::size_t{6} * model->tools});
}

const char* greenloop_polyhedron_error_text(greenloop_polyhedron_error error) {
  return text_at(polyhedron_error_texts, error);
}
const char* greenloop_tool_fault_text(greenloop_tool_fault fault) { return text_at(tool_fault_texts, fault); }
