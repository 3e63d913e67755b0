// What a contact body costs, and how it is made.
#include <cmath>
#include <new>

#include "runtime/contact_body.hpp"
#include "runtime/contact_body/touched_body.hpp"
#include "runtime/contact_body/touching_work.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/memory/fit.hpp"

namespace greenloop {
namespace {

bool in_range(const ContactBody::Limits& limits) {
  const Elastostatic::Limits& body = limits.elastostatic;
  return limits.max_tools >= 1 && limits.max_tools <= 16 && limits.max_points >= 1 &&
         limits.max_points <= Shape::max_points && std::isfinite(limits.margin) && limits.margin >= 0 &&
         std::isfinite(limits.rigid_stiffness) && limits.rigid_stiffness >= 0 && body.iterations > 0 &&
         !body.forces_only;
}

// of all triangles of the finest level, at rest
double mean_edge(const Surface& surface, std::span<const float> area) {
  double sum = 0;
  for (const float of_node : area) sum += double{of_node};
  constexpr double equilateral = 0.4330127018922193;  // area of a triangle with unit edges
  return std::sqrt(sum / (equilateral * surface.triangle_count(surface.level())));
}

// memory that a part carves itself
std::span<std::byte> piece(Arena& arena, std::size_t bytes) { return {arena.take<std::byte>(bytes), bytes}; }

CandidateSearch::Limits search_limits(const ContactBody::Limits& limits, double margin, double fine_radius) {
  return {limits.max_tools, limits.max_points, limits.elastostatic.max_contacts, margin, fine_radius};
}

// units that a search may take, those that it has to have, and of all that finds contacts
struct TouchingWork {
  std::uint64_t search = 0, least_search = 0, whole = 0;
};

TouchingWork touching_work_of(const Model& model, const ContactBody::Limits& limits) {
  const SurfaceSizes surface = DeformedSurface::sizes(model, model.level_count() - 1);
  const CandidateSearch::Limits searched = search_limits(limits, 0, 0);
  TouchingWork work;
  work.least_search = CandidateSearch::least_find_work(searched, surface);
  work.search = limits.search_work > 0 ? limits.search_work : CandidateSearch::usual_find_work(searched, surface);
  const std::uint64_t contacts = limits.elastostatic.max_contacts;
  work.whole =
      surface.update_work() + work.search + limits.max_tools * tool_price + contacts * contact_price +
      most_choosing(contacts, std::uint64_t{CandidateSearch::most_places} * limits.max_tools * limits.max_points);
  if (limits.carried) work.whole += model.node_count() * carried_price;
  return work;
}

void carve_arrays(Arena& arena, const Model& model, const ContactBody::Limits& limits, TouchedBody& body) {
  body.nodes = model.node_count();
  body.max_contacts = limits.elastostatic.max_contacts;
  body.max_tools = limits.max_tools;
  body.tool = arena.take<Tool>(limits.max_tools);
  body.placement = arena.take<Placement>(limits.max_tools);
  body.last_placement = arena.take<Placement>(limits.max_tools);
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
  body.yield = arena.take<float>(body.max_contacts);
  body.by_loads = arena.take<Vec4>(body.max_contacts);
  body.area = arena.take<float>(body.nodes);
  body.held_out = arena.take_zeroed<float>(body.nodes);
  body.state = arena.take<ContactState>(body.max_contacts);
  body.answered = arena.take<ContactBody::Contact>(body.max_contacts);
  body.tool_answer = arena.take<ContactBody::ToolAnswer>(limits.max_tools);
  body.displacement = arena.take_zeroed<Vec4>(body.nodes);
  if (limits.carried) body.carried = arena.take<Vec4>(body.nodes);
  body.grips.carve(arena, body.max_contacts);
}

// elastostatic_bytes: of the elastic body
bool place_parts(Arena& arena, const Model& model, const ContactBody::Limits& limits, std::size_t elastostatic_bytes,
                 TouchedBody& body) {
  const std::uint32_t finest = model.level_count() - 1;
  const auto surface = piece(arena, Surface::required(model, finest).bytes);
  const auto elastostatic = piece(arena, elastostatic_bytes);
  const auto deformed = piece(arena, DeformedSurface::required(model, finest));
  const auto search = piece(arena, CandidateSearch::required(search_limits(limits, 0, 0)));
  if (surface.data() == nullptr) return true;  // it only counts
  const auto made_surface = Surface::create(model, finest, surface);
  const auto made_body = Elastostatic::create(model, limits.elastostatic, elastostatic);
  if (!made_surface || !made_body) return false;
  const auto made_deformed = DeformedSurface::create(made_surface.surface, deformed);
  if (!made_deformed) return false;
  body.surface = made_surface.surface;
  body.deformed = made_deformed.surface;
  body.elastostatic = made_body.body;
  if (!body.surface.areas(finest, {}, {body.area, body.nodes})) return false;
  body.mean_edge = mean_edge(body.surface, {body.area, body.nodes});
  const double margin = limits.margin > 0 ? limits.margin : 0.25 * body.mean_edge;
  const auto made_search = CandidateSearch::create(search_limits(limits, margin, 2 * body.mean_edge), search);
  if (!made_search) return false;
  body.search = made_search.search;
  body.search.heed({body.held_out, body.nodes});
  return true;
}

// how much a place that cannot move gives way
float rigid_softness(const Model& model, const ContactBody::Limits& limits) {
  constexpr double depth = 1e-3;  // m
  const double stiffness = limits.rigid_stiffness > 0 ? limits.rigid_stiffness : model.view().info->young * depth;
  return static_cast<float>(1 / stiffness);
}

// why limits have no requirement
CreateError refusal(const Model& model, const ContactBody::Limits& limits) {
  if (!in_range(limits)) return CreateError::bad_limits;
  const CreateError error = Elastostatic::create(model, limits.elastostatic, {}).error;
  return error == CreateError::unsupported_model ? error : CreateError::bad_limits;
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

// of the elastic body and its tools; zero bytes if there is none
ContactBody::Requirement requirement_of(const Model& model, const ContactBody::Limits& limits,
                                        std::size_t& elastostatic_bytes) {
  ContactBody::Requirement requirement;
  const Elastostatic::Requirement elastostatic = Elastostatic::required(model, limits.elastostatic);
  if (elastostatic.bytes == 0) return {};
  const TouchingWork touching = touching_work_of(model, limits);
  if (touching.search < touching.least_search) return {};
  elastostatic_bytes = elastostatic.bytes;
  requirement.bytes = bytes_of(model, limits, elastostatic.bytes);
  requirement.touching_work = touching.whole;
  requirement.least_work = elastostatic.least_work + touching.whole;
  requirement.worst_work = elastostatic.worst_work[model.level_count() - 1] + touching.whole;
  return requirement;
}

}  // namespace

ContactBody::Requirement ContactBody::required(const Model& model, const Limits& limits) noexcept {
  std::size_t elastostatic_bytes = 0;
  return in_range(limits) ? requirement_of(model, limits, elastostatic_bytes) : Requirement{};
}

ContactBody::Created ContactBody::create(const Model& model, const Limits& limits,
                                         std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  std::size_t elastostatic_bytes = 0;
  const Requirement need = in_range(limits) ? requirement_of(model, limits, elastostatic_bytes) : Requirement{};
  created.requested = need.bytes;
  if (created.requested == 0) {
    created.error = refusal(model, limits);
    return created;
  }
  if (!memory_fits(memory, CreateError::arena_too_small, CreateError::arena_misaligned, created)) return created;
  Arena arena(memory.data());
  auto& body = *new (arena.take<TouchedBody>(1)) TouchedBody;
  carve_arrays(arena, model, limits, body);
  if (!place_parts(arena, model, limits, elastostatic_bytes, body)) {
    created.error = CreateError::unsupported_model;
    return created;
  }
  body.rigid_softness = rigid_softness(model, limits);
  body.least_work = need.least_work;
  body.search_work = touching_work_of(model, limits).search;
  created.body.body_ = &body;
  return created;
}

}  // namespace greenloop
