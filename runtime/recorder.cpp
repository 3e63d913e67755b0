#include "runtime/recorder.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>

#include "formats/verify/crc32c.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/recorder/record.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t most_forces = 1U << 22;  // a response with more is refused like one with so many

template <class Value>
std::uint32_t add(std::uint32_t digest, const Value& value) {
  return crc32c(std::as_bytes(std::span(&value, 1)), digest);
}

std::uint64_t address(const void* at) { return reinterpret_cast<std::uintptr_t>(at); }

const std::byte* arena_of(const Record& record) {
  return std::bit_cast<const std::byte*>(static_cast<std::uintptr_t>(record.arena_address));
}

std::byte* at(Record& record, std::uint64_t offset) { return reinterpret_cast<std::byte*>(&record) + offset; }

// offsets of all parts, and the size of the whole
void carve(Arena& arena, const Elastostatic::Limits& limits, const Recorder::Options& options, Record& record) {
  const auto take = [&](std::uint64_t bytes) {
    const std::uint64_t offset = arena.bytes();
    static_cast<void>(arena.take_zeroed<std::byte>(bytes));
    return offset;
  };
  take(sizeof(Record));
  record.slot_bytes = sizeof(RecordedStep) + sizeof(Constraint) * most_constraints(limits);
  record.slot_bytes = (record.slot_bytes + 7) / 8 * 8;
  record.steps_offset = take(record.slot_bytes * options.steps);
  for (Checkpoint& checkpoint : record.checkpoint) checkpoint = {no_step, take(record.arena_bytes)};
  record.bytes = arena.bytes();
}

void describe(const Model& model, const Elastostatic::Limits& limits, const Recorder::Options& options,
              Record& record) {
  std::memcpy(record.magic, record_magic, sizeof record.magic);
  record.version = record_version;
  record.pointer_bytes = sizeof(void*);
  record.model_address = address(model.view().header);
  record.model_bytes = model.view().header->file_bytes;
  record.model_crc = model.view().header->header_crc;
  record.limits = limits;
  record.steps = options.steps;
  record.interval = options.interval;
  record.field_nodes = options.field_nodes;
}

void copy_arena(Record& record, Checkpoint& checkpoint) {
  checkpoint.step = no_step;
  std::memcpy(at(record, checkpoint.offset), arena_of(record), static_cast<std::size_t>(record.arena_bytes));
  checkpoint.step = record.begun;
}

RecordedStep* begin_step(Record& record, std::span<const Constraint> contacts, Budget budget,
                         const Elastostatic::Response& response) {
  std::byte* const slot = at(record, record.steps_offset + record.slot_bytes * (record.begun % record.steps));
  const bool aligned = address(response.displacement.data()) % 16 == 0;
  auto* const step =
      new (slot) RecordedStep{.number = record.begun,
                              .budget = budget.work,
                              .contacts = std::min<std::uint64_t>(contacts.size(), most_constraints(record.limits) + 1),
                              .forces = std::min<std::uint64_t>(response.force.size(), most_forces),
                              .displaced_nodes = response.displacement.size(),
                              .displacement_aligned = aligned ? 1U : 0U,
                              .finished = 0,
                              .status = 0,
                              .digest = 0};
  const std::size_t kept = std::min<std::size_t>(contacts.size(), most_constraints(record.limits));
  if (kept > 0) std::memcpy(slot + sizeof(RecordedStep), contacts.data(), kept * sizeof(Constraint));
  ++record.begun;
  return step;
}

}  // namespace

std::uint32_t outcome_digest(const Elastostatic::StepReport& report, const Elastostatic::Response& response,
                             std::uint64_t field_nodes) noexcept {
  const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status),
                                 report.refused,
                                 report.constraint_level,
                                 report.constraint_level,
                                 report.details.held_contacts,
                                 report.field_level,
                                 std::bit_cast<std::uint32_t>(report.error),
                                 report.details.cached_factor ? 1U : 0U,
                                 report.details.changed_nodes,
                                 report.work,
                                 report.details.pending_work,
                                 std::bit_cast<std::uint32_t>(report.details.glide),
                                 std::bit_cast<std::uint32_t>(report.details.level_difference),
                                 std::bit_cast<std::uint64_t>(report.details.switch_work)};
  const std::uint32_t digest = add(0, facts);
  if (!answered(report.status)) return digest;
  const auto nodes = static_cast<std::size_t>(std::min<std::uint64_t>(response.displacement.size(), field_nodes));
  return crc32c(std::as_bytes(response.displacement.first(nodes)), crc32c(std::as_bytes(response.force), digest));
}

Recorder::Requirement Recorder::required(const Model& model, const Elastostatic::Limits& limits,
                                         const Options& options) noexcept {
  Record record{};
  record.arena_bytes = Elastostatic::required(model, limits).bytes;
  if (record.arena_bytes == 0 || options.steps == 0) return {};
  Arena counting;
  carve(counting, limits, options, record);
  if (record.bytes > SIZE_MAX) return {};
  const std::uint64_t step = record.slot_bytes + sizeof record.begun;
  return {static_cast<std::size_t>(record.bytes), layout::alignment, static_cast<std::size_t>(record.arena_bytes),
          static_cast<std::size_t>(step)};
}

Recorder::Created Recorder::create(const Model& model, const Elastostatic::Limits& limits,
                                   std::span<const std::byte> arena, const Options& options,
                                   std::span<std::byte> memory) noexcept {
  Created created;
  created.available = memory.size();
  const Requirement requirement = required(model, limits, options);
  created.requested = requirement.bytes;
  if (options.steps == 0) {
    created.error = Error::bad_options;
  } else if (requirement.bytes == 0 || arena.size() < requirement.checkpoint_bytes) {
    created.error = Error::bad_body;
  } else if (requirement.bytes > memory.size()) {
    created.error = Error::memory_too_small;
    created.missing = requirement.bytes - memory.size();
  } else if (address(memory.data()) % requirement.alignment != 0) {
    created.error = Error::memory_misaligned;
  }
  if (!created) return created;
  Record described{};
  described.arena_address = address(arena.data());
  described.arena_bytes = requirement.checkpoint_bytes;
  describe(model, limits, options, described);
  Arena placing(memory.data());
  carve(placing, limits, options, described);
  created.recorder.record_ = new (memory.data()) Record(described);
  copy_arena(*created.recorder.record_, created.recorder.record_->checkpoint[0]);
  return created;
}

Elastostatic::StepReport Recorder::step(Elastostatic& body, std::span<const Constraint> contacts, Budget budget,
                                        const Elastostatic::Response& response) noexcept {
  if (record_->interval > 0 && record_->begun > 0 && record_->begun % record_->interval == 0) checkpoint();
  RecordedStep* const step = begin_step(*record_, contacts, budget, response);
  const Elastostatic::StepReport report = body.step(contacts, budget, response);
  step->status = static_cast<std::uint32_t>(report.status);
  step->digest = outcome_digest(report, response, record_->field_nodes);
  step->finished = 1;
  return report;
}

void Recorder::checkpoint() noexcept {
  Checkpoint& first = record_->checkpoint[1];
  Checkpoint& second = record_->checkpoint[2];
  const bool first_is_older = first.step == no_step || (second.step != no_step && first.step < second.step);
  copy_arena(*record_, first_is_older ? first : second);
}

std::span<const std::byte> Recorder::record() const noexcept {
  return {reinterpret_cast<const std::byte*>(record_), static_cast<std::size_t>(record_->bytes)};
}

}  // namespace greenloop
