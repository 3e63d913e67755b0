#pragma once

#include "formats/verify/section_table.hpp"

namespace greenloop {

/// Takes the section Provenance, which follows Info in every file, verifies it and adds it to `view`. Returns whether
/// it is right and otherwise says in `result` what is not. Work: linear in the section.
bool verify_provenance(SectionTable& table, FileView& view, VerifyResult& result);

}  // namespace greenloop
