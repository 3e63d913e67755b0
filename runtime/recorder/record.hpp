#pragma once

// What a Recorder keeps, in the memory it was given and in the file that this is written to: the same bytes, in the
// order of the machine. All offsets are from the start.
//
//   offset 0       Record              with the body's limits and where its arena and its model stood
//   steps_offset   Slot [steps]        a ring: step n is in slot n modulo steps; slot_bytes each:
//                                      RecordedStep, then Constraint [max_contacts]
//   checkpoint     arena_bytes each    copies of the arena before a step, of which the first is before step 0

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "runtime/elastostatic.hpp"

namespace greenloop {

inline constexpr char record_magic[8] = {'G', 'R', 'E', 'E', 'N', 'L', 'R', '\n'};
inline constexpr std::uint32_t record_version = 3;
inline constexpr std::uint64_t no_step = ~std::uint64_t{0};

struct Checkpoint {
  std::uint64_t step;  ///< the first not in it; no_step: not taken
  std::uint64_t offset;
};

struct Record {
  static constexpr std::uint32_t checkpoints = 3;

  char magic[8];
  std::uint32_t version;
  std::uint32_t pointer_bytes;  ///< of the machine
  std::uint64_t bytes;          ///< of the whole record
  std::uint64_t arena_address;
  std::uint64_t arena_bytes;
  std::uint64_t model_address;
  std::uint64_t model_bytes;
  std::uint32_t model_crc;  ///< layout::Header::header_crc
  std::uint32_t steps;      ///< of the ring
  Elastostatic::Limits limits;
  std::uint64_t interval;
  std::uint64_t field_nodes;
  std::uint64_t begun;  ///< steps, of which all but the last are finished for certain
  std::uint64_t steps_offset;
  std::uint64_t slot_bytes;
  Checkpoint checkpoint[checkpoints];
};

struct RecordedStep {
  std::uint64_t number;
  std::uint64_t budget;
  std::uint64_t
      contacts;  ///< as many as were given, or one more than most_constraints where more were, which are refused alike
  std::uint64_t forces;
  std::uint64_t displaced_nodes;
  std::uint32_t displacement_aligned;  ///< 1: at a multiple of 16 bytes
  std::uint32_t finished;              ///< 1: it came back, and the rest is of its outcome
  std::uint32_t status;
  std::uint32_t digest;  ///< outcome_digest
};
static_assert(std::is_trivially_copyable_v<Record> && sizeof(RecordedStep) == 56);

/// Constraints that a step takes, of all kinds.
constexpr std::uint64_t most_constraints(const Elastostatic::Limits& limits) noexcept {
  return std::uint64_t{limits.max_contacts} + limits.max_forces;
}

/// CRC-32C of what a step reported and, if it answered, of its forces and of the first `field_nodes` nodes'
/// displacement. For the loop; work: linear in these.
[[nodiscard]] std::uint32_t outcome_digest(const Elastostatic::StepReport& report,
                                           const Elastostatic::Response& response, std::uint64_t field_nodes) noexcept;

}  // namespace greenloop
