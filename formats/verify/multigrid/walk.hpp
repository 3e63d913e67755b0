#pragma once

#include "formats/verify/section_table.hpp"

namespace greenloop::multigrid {

/// Verifies the sections of a multigrid model, of which Info has been taken from the table, and fills `view`.
/// Returns whether they are right and otherwise says in `result` what is not. Work: linear in the file.
bool verify_sections(const Section& info, SectionTable& table, ModelView& view, VerifyResult& result);

}  // namespace greenloop::multigrid
