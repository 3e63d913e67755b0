#pragma once

#include "formats/verify.hpp"
#include "formats/verify/section_table.hpp"

// One function per kind of section: verifies it against what `view` already holds, then adds it to `view`.
// Each returns whether the section is right and otherwise says in `result` what is not. Work: linear in the section.

namespace greenloop {

/// What a section may rely on besides the view.
struct VerifyContext {
  ModelView& view;
  VerifyResult& result;
  bool reserved_is_zero;          ///< false if a newer minor version wrote the file
  std::uint64_t kept_blocks = 0;  ///< scales and coupling blocks in the sections seen so far
};

bool verify_info(const Section& section, VerifyContext& context);
bool verify_provenance(const Section& section, VerifyContext& context);
bool verify_level(const Section& section, VerifyContext& context);
bool verify_nodes(const Section& section, VerifyContext& context);
bool verify_base_triangles(const Section& section, VerifyContext& context);
bool verify_refinement(const Section& section, VerifyContext& context);
bool verify_stencils(const Section& section, VerifyContext& context);
bool verify_predictions(const Section& section, VerifyContext& context);
bool verify_representatives(const Section& section, VerifyContext& context);
bool verify_scales(const Section& section, VerifyContext& context);
bool verify_couplings(const Section& section, VerifyContext& context);
bool verify_patterns(const Section& section, VerifyContext& context);

/// Domain nodes of K(q), the level's own included; Level(q) must have been seen.
[[nodiscard]] std::uint32_t domain_of_mesh(const ModelView& view, std::uint32_t q);

/// After the last section of level q: Level(q) counts what the sections up to here hold.
bool verify_counts(std::uint32_t q, VerifyContext& context);

}  // namespace greenloop
