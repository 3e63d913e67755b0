#pragma once

#include "formats/verify/section_check.hpp"

// One function per kind of section: verifies it against what `view` already holds, then adds it to `view`.
// Each returns whether the section is right and otherwise says in `result` what is not. Work: linear in the section.

namespace greenloop::multigrid {

/// What a section may rely on.
struct VerifyContext {
  MultigridView& view;
  VerifyResult& result;
  std::uint32_t levels;   ///< that the header announces
  bool reserved_is_zero;  ///< false if a newer minor version wrote the file
  // of the grid whose sections come
  std::uint32_t blocks = 0, parents = 0, coarser = 0;
};

bool verify_info(const Section& section, VerifyContext& context);
bool verify_level(const Section& section, VerifyContext& context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  bool verify_##kind(const Section& section, VerifyContext& context);
GREENLOOP_MULTIGRID_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW

}  // namespace greenloop::multigrid
