#pragma once

#include "formats/verify/section_check.hpp"

// One function per kind of section: verifies it against what `view` already holds, then adds it to `view`.
// Each returns whether the section is right and otherwise says in `result` what is not. Work: linear in the section.

namespace greenloop::impulse_response {

/// What a section may rely on.
struct VerifyContext {
  ImpulseResponseView& view;
  VerifyResult& result;
  std::uint32_t levels;   ///< that the header announces
  bool reserved_is_zero;  ///< false if a newer minor version wrote the file
};

bool verify_info(const Section& section, VerifyContext& context);
bool verify_level(const Section& section, VerifyContext& context);
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  bool verify_##kind(const Section& section, VerifyContext& context);
GREENLOOP_IMPULSE_RESPONSE_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW

}  // namespace greenloop::impulse_response
