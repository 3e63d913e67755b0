#pragma once

#include "formats/verify/section_check.hpp"

// One function per kind of section: verifies it against what `view` already holds, then adds it to `view`.
// Each returns whether the section is right and otherwise says in `result` what is not. Work: linear in the section.

namespace greenloop::elastostatic {

/// What a section may rely on.
struct VerifyContext {
  ElastostaticView& view;
  VerifyResult& result;
  std::uint32_t levels;           ///< mesh levels the header announces
  bool reserved_is_zero;          ///< false if a newer minor version wrote the file
  std::uint64_t kept_blocks = 0;  ///< scales and coupling blocks in the sections seen so far
};

bool verify_info(const Section& section, VerifyContext& context);
bool verify_level(const Section& section, VerifyContext& context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  bool verify_##kind(const Section& section, VerifyContext& context);
GREENLOOP_ELASTOSTATIC_SECTIONS(GREENLOOP_ROW)
GREENLOOP_READY_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW

/// Domain nodes of K(q), the level's own included; Level(q) must have been seen.
[[nodiscard]] std::uint32_t domain_of_mesh(const ElastostaticView& view, std::uint32_t q);

/// The bytes of an index of so many rows: 2, if that is enough, or 4.
bool verify_index_bytes(SectionCheck& check, std::uint32_t index_bytes, std::uint32_t rows);

/// After the last section of level q: Level(q) counts what the sections up to here hold.
bool verify_counts(std::uint32_t q, VerifyContext& context);

}  // namespace greenloop::elastostatic
