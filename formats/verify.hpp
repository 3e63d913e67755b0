#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/view.hpp"

namespace greenloop {

/// Why a file was refused. One value per rule, so that a test can name the rule it breaks.
enum class VerifyRule : std::uint8_t {
  ok,
  misaligned_memory,
  too_short,
  bad_magic,
  foreign_endianness,
  unsupported_major,
  wrong_length,
  header_checksum,
  table_checksum,
  section_out_of_bounds,
  section_misaligned,
  section_overlap,
  section_order,
  section_missing,
  section_duplicate,
  section_size,
  section_checksum,
  padding_not_zero,
  reserved_not_zero,
  bad_enum,
  out_of_range,
  not_finite,
  not_increasing,
  inconsistent,
};

/// The verdict of verify. Text for people is made from it by describe (formats/write/describe.hpp), outside the loop.
struct VerifyResult {
  VerifyRule rule = VerifyRule::ok;
  layout::SectionKind kind = {};  ///< section at fault; 0 for the header and the table
  std::uint16_t a = 0, b = 0;     ///< its indices
  const char* field = "";         ///< name of the field, static storage
  std::uint64_t index = 0;        ///< of the element within the section
  double value = 0;               ///< what stands there
  double limit = 0;               ///< what was allowed

  [[nodiscard]] bool ok() const { return rule == VerifyRule::ok; }
};

/// Verifies a whole model file once, field by field, and fills `view` if and only if it is right.
/// `bytes` must be 64-byte aligned. Newer major version: refused; newer minor: unknown sections are skipped.
/// Work: linear in the bytes. No heap, no exception; not for the loop itself (start-up).
[[nodiscard]] VerifyResult verify(std::span<const std::byte> bytes, ModelView& view) noexcept;

}  // namespace greenloop
