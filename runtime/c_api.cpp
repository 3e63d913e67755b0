#include <bit>
#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>

#include "formats/verify/rule_text.hpp"
#include "runtime/c_values.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

static_assert(GREENLOOP_MAX_LEVELS == layout::max_levels && GREENLOOP_ALIGNMENT == layout::alignment &&
              GREENLOOP_NO_CONSTRAINT == StepReport::no_constraint);

template <class C, class Cpp>
constexpr bool same(C c, Cpp cpp) {
  return static_cast<int>(c) == static_cast<int>(cpp);
}

static_assert(same(GREENLOOP_RULE_OK, VerifyRule::ok) &&
              same(GREENLOOP_RULE_MISALIGNED_MEMORY, VerifyRule::misaligned_memory) &&
              same(GREENLOOP_RULE_TOO_SHORT, VerifyRule::too_short) &&
              same(GREENLOOP_RULE_BAD_MAGIC, VerifyRule::bad_magic) &&
              same(GREENLOOP_RULE_FOREIGN_ENDIANNESS, VerifyRule::foreign_endianness) &&
              same(GREENLOOP_RULE_UNSUPPORTED_MAJOR, VerifyRule::unsupported_major) &&
              same(GREENLOOP_RULE_WRONG_LENGTH, VerifyRule::wrong_length) &&
              same(GREENLOOP_RULE_HEADER_CHECKSUM, VerifyRule::header_checksum) &&
              same(GREENLOOP_RULE_TABLE_CHECKSUM, VerifyRule::table_checksum) &&
              same(GREENLOOP_RULE_SECTION_OUT_OF_BOUNDS, VerifyRule::section_out_of_bounds) &&
              same(GREENLOOP_RULE_SECTION_MISALIGNED, VerifyRule::section_misaligned) &&
              same(GREENLOOP_RULE_SECTION_OVERLAP, VerifyRule::section_overlap) &&
              same(GREENLOOP_RULE_SECTION_ORDER, VerifyRule::section_order) &&
              same(GREENLOOP_RULE_SECTION_MISSING, VerifyRule::section_missing) &&
              same(GREENLOOP_RULE_SECTION_DUPLICATE, VerifyRule::section_duplicate) &&
              same(GREENLOOP_RULE_SECTION_SIZE, VerifyRule::section_size) &&
              same(GREENLOOP_RULE_SECTION_CHECKSUM, VerifyRule::section_checksum) &&
              same(GREENLOOP_RULE_PADDING_NOT_ZERO, VerifyRule::padding_not_zero) &&
              same(GREENLOOP_RULE_RESERVED_NOT_ZERO, VerifyRule::reserved_not_zero) &&
              same(GREENLOOP_RULE_BAD_ENUM, VerifyRule::bad_enum) &&
              same(GREENLOOP_RULE_OUT_OF_RANGE, VerifyRule::out_of_range) &&
              same(GREENLOOP_RULE_NOT_FINITE, VerifyRule::not_finite) &&
              same(GREENLOOP_RULE_NOT_INCREASING, VerifyRule::not_increasing) &&
              same(GREENLOOP_RULE_INCONSISTENT, VerifyRule::inconsistent));
static_assert(same(GREENLOOP_CREATE_OK, CreateError::none) &&
              same(GREENLOOP_CREATE_ARENA_TOO_SMALL, CreateError::arena_too_small) &&
              same(GREENLOOP_CREATE_ARENA_MISALIGNED, CreateError::arena_misaligned) &&
              same(GREENLOOP_CREATE_BAD_LIMITS, CreateError::bad_limits) &&
              same(GREENLOOP_CREATE_UNSUPPORTED_MODEL, CreateError::unsupported_model));
static_assert(same(GREENLOOP_OK, Status::ok) && same(GREENLOOP_COARSER, Status::coarser) &&
              same(GREENLOOP_HELD_NOT_FINITE, Status::held_not_finite) &&
              same(GREENLOOP_HELD_OUT_OF_RANGE, Status::held_out_of_range) &&
              same(GREENLOOP_HELD_NOT_TOUCHABLE, Status::held_not_touchable) &&
              same(GREENLOOP_HELD_DUPLICATE, Status::held_duplicate) &&
              same(GREENLOOP_HELD_RESPONSE_SIZE, Status::held_response_size) &&
              same(GREENLOOP_HELD_OVER_BUDGET, Status::held_over_budget) &&
              same(GREENLOOP_HELD_SINGULAR, Status::held_singular) &&
              same(GREENLOOP_HELD_OVERFLOW, Status::held_overflow) &&
              same(GREENLOOP_HELD_UNSUPPORTED, Status::held_unsupported) && GREENLOOP_HELD_UNSUPPORTED + 1 == statuses);
static_assert(same(GREENLOOP_HOLD, Constraint::Kind::hold) && same(GREENLOOP_NORMAL, Constraint::Kind::normal) &&
              same(GREENLOOP_FORCE, Constraint::Kind::force) && same(GREENLOOP_PATTERN, Constraint::Kind::pattern));
static_assert(same(GREENLOOP_PROBLEM_ELASTOSTATIC, layout::Problem::elastostatic));

// NOLINTBEGIN(misc-redundant-expression): two types are compared
static_assert(sizeof(Model) <= sizeof(greenloop_model) && alignof(Model) <= alignof(greenloop_model) &&
              std::is_trivially_destructible_v<Model>);
static_assert(sizeof(Constraint) == sizeof(greenloop_constraint) &&
              alignof(Constraint) == alignof(greenloop_constraint) &&
              offsetof(Constraint, node) == offsetof(greenloop_constraint, node) &&
              offsetof(Constraint, value) == offsetof(greenloop_constraint, value) &&
              offsetof(Constraint, kind) == offsetof(greenloop_constraint, kind));
// NOLINTEND(misc-redundant-expression)
static_assert(sizeof(Elastostatic) == sizeof(void*) && std::is_trivially_copyable_v<Elastostatic>);

const layout::NodeRecord* find_node(const greenloop_model* model, std::uint32_t node) {
  const ModelView& view = model_in(model).view();
  return node < view.node_count ? &node_record(view, node) : nullptr;
}

constexpr const char* create_error_texts[] = {
    "the body was created",
    "the arena is too small: give it as many bytes as were requested",
    "the arena is not 64-byte aligned",
    "the limits are out of range: 1..4096 contacts, 1..1024 cached factors, at most 256 cycles of a glide",
    "the model is not one of a subdivided triangulation, or a force reaches too much of it, or it is too large",
};

constexpr const char* status_texts[] = {
    "answered at the finest level",
    "answered within the budget at a coarser level, or gliding to the finest",
    "held: a contact's displacement is NaN or infinite",
    "held: a contact names no node of the model, or there are more contacts than the limits allow",
    "held: a contact names a node that the scene did not declare touchable",
    "held: two contacts name the same node",
    "held: the field's buffer is not 16-byte aligned",
    "held: the budget is below the least work",
    "held: the capacitance matrix is not positive definite to working precision",
    "held: the forces are too large for a finite field",
    "held: a constraint is of a kind that the solver does not know",
};

template <std::size_t count>
const char* text_at(const char* const (&texts)[count], unsigned index) {
  return index < count ? texts[index] : "unknown";
}

}  // namespace

Elastostatic::Limits limits_of(greenloop_elastostatic_limits limits) noexcept {
  Elastostatic::Limits same{.max_contacts = limits.max_contacts,
                            .cached_factors = limits.cached_factors,
                            .forces_only = limits.forces_only != 0,
                            .mixtures = limits.no_mixtures == 0,
                            .keep_capacitance = limits.keep_capacitance != 0};
  same.glide_cycles = limits.glide_cycles == 0 ? same.glide_cycles : limits.glide_cycles;
  same.refining_work = limits.refining_work == 0 ? same.refining_work : limits.refining_work;
  return same;
}

greenloop_elastostatic_report report_of(const Elastostatic::StepReport& report) noexcept {
  const Elastostatic::StepDetails& details = report.details;
  return {static_cast<greenloop_status>(report.status),
          report.refused,
          report.work,
          report.constraint_level,
          report.field_level,
          report.error,
          {details.cached_factor ? 1 : 0, details.finer_level, details.finer_contacts, details.changed_nodes,
           details.glide, details.level_difference, details.switch_work, details.pending_work}};
}

}  // namespace greenloop

using namespace greenloop;

greenloop_fault greenloop_open(const void* bytes, size_t size, greenloop_model* model) {
  const auto opened = Model::open({static_cast<const std::byte*>(bytes), size});
  new (model->storage) Model(opened.model);
  const VerifyResult& result = opened.result;
  return {static_cast<greenloop_rule>(result.rule),
          static_cast<std::uint32_t>(result.kind),
          result.a,
          result.b,
          result.field,
          result.index,
          result.value,
          result.limit};
}

uint32_t greenloop_node_count_to(const greenloop_model* model, uint32_t level) {
  return level < model_in(model).level_count() ? model_in(model).node_count(level) : 0;
}
greenloop_version_numbers greenloop_version(void) {
  return {GREENLOOP_VERSION_MAJOR, GREENLOOP_VERSION_MINOR, GREENLOOP_VERSION_PATCH, layout::version_major,
          layout::version_minor};
}

int greenloop_answered(greenloop_status status) { return answered(static_cast<Status>(status)) ? 1 : 0; }

greenloop_problem greenloop_model_problem(const greenloop_model* model) {
  return static_cast<greenloop_problem>(model_in(model).view().info->problem);
}

uint32_t greenloop_node_count(const greenloop_model* model) { return model_in(model).node_count(); }

uint32_t greenloop_level_count(const greenloop_model* model) { return model_in(model).level_count(); }

int greenloop_is_touchable(const greenloop_model* model, uint32_t node) {
  const layout::NodeRecord* record = find_node(model, node);
  return record != nullptr && (record->flags & layout::node_touchable) != 0 ? 1 : 0;
}

int greenloop_position(const greenloop_model* model, uint32_t node, float* position) {
  const layout::NodeRecord* record = find_node(model, node);
  if (record == nullptr) {
    return 0;
  }
  std::memcpy(position, record->position, sizeof record->position);
  return 1;
}

greenloop_elastostatic_intent greenloop_elastostatic_intended(const greenloop_model* model) {
  const Elastostatic::Intent intent = Elastostatic::intended(model_in(model));
  const Elastostatic::Limits& limits = intent.limits;
  return {{limits.max_contacts, limits.cached_factors, limits.forces_only ? 1 : 0, limits.mixtures ? 0 : 1,
           limits.keep_capacitance ? 1 : 0, limits.glide_cycles, limits.refining_work},
          intent.budget.work,
          intent.rate};
}

greenloop_elastostatic_requirement greenloop_elastostatic_required(const greenloop_model* model,
                                                                   greenloop_elastostatic_limits limits) {
  const Elastostatic::Requirement need = Elastostatic::required(model_in(model), limits_of(limits));
  greenloop_elastostatic_requirement requirement = {need.bytes, need.least_work, {}};
  std::memcpy(requirement.worst_work, need.worst_work, sizeof need.worst_work);
  return requirement;
}

greenloop_elastostatic_created greenloop_elastostatic_create(const greenloop_model* model,
                                                             greenloop_elastostatic_limits limits, void* arena,
                                                             size_t bytes) {
  const auto created =
      Elastostatic::create(model_in(model), limits_of(limits), {static_cast<std::byte*>(arena), bytes});
  return {static_cast<greenloop_create_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_elastostatic*>(std::bit_cast<Body*>(created.body))};
}

greenloop_elastostatic_report greenloop_elastostatic_step(greenloop_elastostatic* body,
                                                          const greenloop_constraint* contacts, size_t count,
                                                          uint64_t work, float* force, float* displacement,
                                                          uint32_t nodes) {
  return report_of(
      body_in(body).step(constraints_of(contacts, count), {work}, response_of(count, force, displacement, nodes)));
}

int greenloop_elastostatic_compliance(const greenloop_elastostatic* body, uint32_t i, uint32_t j, float* block) {
  const auto* const in_arena = reinterpret_cast<const Body*>(body);
  const auto same = std::bit_cast<Elastostatic>(in_arena);
  return same.compliance(i, j, std::span<float, 9>(block, 9)) ? 1 : 0;
}

const char* greenloop_rule_text(greenloop_rule rule) { return rule_text(static_cast<VerifyRule>(rule)).meaning; }

const char* greenloop_create_error_text(greenloop_create_error error) {
  return text_at(create_error_texts, static_cast<unsigned>(error));
}

const char* greenloop_status_text(greenloop_status status) {
  return text_at(status_texts, static_cast<unsigned>(status));
}
