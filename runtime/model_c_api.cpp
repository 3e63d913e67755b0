// What greenloop.h says of the library, of models and of every solver.
#include <cstring>
#include <new>
#include <type_traits>

#include "formats/verify/rule_text.hpp"
#include "runtime/c_values.hpp"

namespace greenloop {
namespace {

static_assert(GREENLOOP_MAX_LEVELS == layout::max_levels && GREENLOOP_ALIGNMENT == layout::alignment &&
              GREENLOOP_NO_CONSTRAINT == StepReport::no_constraint);
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
              same(GREENLOOP_CREATE_UNSUPPORTED_MODEL, CreateError::unsupported_model) &&
              same(GREENLOOP_CREATE_MISMATCHED_MODELS, CreateError::mismatched_models));
static_assert(same(GREENLOOP_OK, Status::ok) && same(GREENLOOP_COARSER, Status::coarser) &&
              same(GREENLOOP_HELD_NOT_FINITE, Status::held_not_finite) &&
              same(GREENLOOP_HELD_OUT_OF_RANGE, Status::held_out_of_range) &&
              same(GREENLOOP_HELD_NOT_TOUCHABLE, Status::held_not_touchable) &&
              same(GREENLOOP_HELD_DUPLICATE, Status::held_duplicate) &&
              same(GREENLOOP_HELD_RESPONSE_SIZE, Status::held_response_size) &&
              same(GREENLOOP_HELD_OVER_BUDGET, Status::held_over_budget) &&
              same(GREENLOOP_HELD_SINGULAR, Status::held_singular) &&
              same(GREENLOOP_HELD_OVERFLOW, Status::held_overflow) &&
              same(GREENLOOP_HELD_UNSUPPORTED, Status::held_unsupported) &&
              same(GREENLOOP_HELD_BAD_SURFACE, Status::held_bad_surface) &&
              same(GREENLOOP_HELD_UNSOLVED, Status::held_unsolved) &&
              same(GREENLOOP_HELD_ILLEGAL_IMPULSE, Status::held_illegal_impulse) &&
              GREENLOOP_HELD_ILLEGAL_IMPULSE + 1 == statuses);
static_assert(same(GREENLOOP_HOLD, Constraint::Kind::hold) && same(GREENLOOP_NORMAL, Constraint::Kind::normal) &&
              same(GREENLOOP_FORCE, Constraint::Kind::force) && same(GREENLOOP_PATTERN, Constraint::Kind::pattern) &&
              same(GREENLOOP_MASK, Constraint::Kind::mask) && same(GREENLOOP_ALONG, Constraint::Kind::along));
static_assert(same(GREENLOOP_PROBLEM_ELASTOSTATIC, layout::Problem::elastostatic) &&
              same(GREENLOOP_PROBLEM_SCALAR, layout::Problem::scalar) &&
              same(GREENLOOP_PROBLEM_IMPULSE_RESPONSE, layout::Problem::impulse_response) &&
              same(GREENLOOP_PROBLEM_MULTIGRID, layout::Problem::multigrid));
// NOLINTBEGIN(misc-redundant-expression): two types are compared
static_assert(sizeof(Model) <= sizeof(greenloop_model) && alignof(Model) <= alignof(greenloop_model) &&
              std::is_trivially_destructible_v<Model>);
// NOLINTEND(misc-redundant-expression)

constexpr const char* create_error_texts[] = {
    "the body was created",
    "the arena is too small: give it as many bytes as were requested",
    "the arena is not 64-byte aligned",
    "the limits are out of range: 1..4096 contacts, 1..1024 cached factors, at most 256 cycles of a glide",
    "the model is of another problem, not of a subdivided triangulation, too large, or a force reaches too much of it",
    "the two models are not of the same surface: a node of one has no vertex of the other at its place",
};

constexpr const char* status_texts[] = {
    "answered at the finest level",
    "answered within the budget at a coarser level, or gliding to the finest",
    "held: a contact's displacement is NaN or infinite",
    "held: a contact names no node of the model, or there are more contacts than the limits allow",
    "held: a contact names a node that the scene did not declare touchable",
    "held: two contacts name the same node",
    "held: not one force a contact, or a field of another size than some levels have, or not 16-byte aligned",
    "held: the budget is below the least work",
    "held: the capacitance matrix is not positive definite to working precision",
    "held: the forces are too large for a finite field",
    "held: a constraint is of a kind that the solver does not know",
    "held: a unilateral contact has no unit normal, weights of more than 1 in all, or a negative number",
    "held: the laws of contact have no finite solution; numbers are too large, or a compliance is indefinite",
    "held: an impulse may not follow the last one",
};

}  // namespace
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

greenloop_version_numbers greenloop_version(void) {
  return {GREENLOOP_VERSION_MAJOR, GREENLOOP_VERSION_MINOR, GREENLOOP_VERSION_PATCH, layout::version_major,
          layout::version_minor};
}

int greenloop_answered(greenloop_status status) { return answered(static_cast<Status>(status)) ? 1 : 0; }

greenloop_problem greenloop_model_problem(const greenloop_model* model) {
  return static_cast<greenloop_problem>(model_in(model).problem());
}

uint32_t greenloop_node_count(const greenloop_model* model) { return model_in(model).node_count(); }

uint32_t greenloop_node_count_to(const greenloop_model* model, uint32_t level) {
  return level < model_in(model).level_count() ? model_in(model).node_count(level) : 0;
}

uint32_t greenloop_level_count(const greenloop_model* model) { return model_in(model).level_count(); }

int greenloop_is_touchable(const greenloop_model* model, uint32_t node) {
  return model_in(model).is_touchable(node) ? 1 : 0;
}

int greenloop_position(const greenloop_model* model, uint32_t node, float* position) {
  if (node >= model_in(model).node_count()) {
    return 0;
  }
  const Vec3 place = model_in(model).position(node);
  std::memcpy(position, &place, sizeof place);
  return 1;
}

const char* greenloop_rule_text(greenloop_rule rule) {
  const bool known = static_cast<unsigned>(rule) <= static_cast<unsigned>(VerifyRule::inconsistent);
  return known ? rule_text(static_cast<VerifyRule>(rule)).meaning : "unknown";
}

const char* greenloop_create_error_text(greenloop_create_error error) {
  return text_at(create_error_texts, static_cast<unsigned>(error));
}

const char* greenloop_status_text(greenloop_status status) {
  return text_at(status_texts, static_cast<unsigned>(status));
}
