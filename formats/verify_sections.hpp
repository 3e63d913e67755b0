#pragma once

#include "formats/section_table.hpp"
#include "formats/verify.hpp"

// One function per kind of section: verifies it against what `view` already holds, then adds it to `view`.
// Each returns whether the section is right and otherwise says in `result` what is not. Work: linear in the section.

namespace greenloop {

/// What a section may rely on besides the view.
struct VerifyContext {
  ModelView& view;
  VerifyResult& result;
  bool reserved_is_zero;                                  ///< false if a newer minor version wrote the file
  std::uint64_t present_blocks[layout::max_levels] = {};  ///< of each constraint level, in the sections seen so far
};

bool verify_info(const Section& section, VerifyContext& context);
bool verify_provenance(const Section& section, VerifyContext& context);
bool verify_level(const Section& section, VerifyContext& context);
bool verify_nodes(const Section& section, VerifyContext& context);
bool verify_base_triangles(const Section& section, VerifyContext& context);
bool verify_refinement(const Section& section, VerifyContext& context);
bool verify_columns(const Section& section, VerifyContext& context);
bool verify_representatives(const Section& section, VerifyContext& context);
bool verify_blocks(const Section& section, VerifyContext& context);

/// After the last section: the counts in every Level agree with what the sections hold.
bool verify_counts(VerifyContext& context);

}  // namespace greenloop
