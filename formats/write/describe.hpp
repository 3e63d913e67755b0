#pragma once

#include <string>
#include <string_view>

#include "formats/verify.hpp"

namespace greenloop {

/// "Nodes(2)": the section's name with its indices as in layout.hpp. Offline only.
[[nodiscard]] std::string section_name(layout::SectionKind kind, std::uint32_t a, std::uint32_t b);

/// "elastostatic": the name of a problem; "unknown" if it is none. Offline only.
[[nodiscard]] std::string_view problem_name(layout::Problem problem);

/// "lifted linear": the name of a layout::Wavelet; "unknown" if it is none. Offline only.
[[nodiscard]] std::string_view wavelet_name(std::uint32_t wavelet);

/// "pinch": the name of a layout::PatternKind; "unknown" if it is none. Offline only.
[[nodiscard]] std::string_view pattern_name(std::uint32_t kind);

/// "acceleration along x" or the name of a pressure. Offline only.
[[nodiscard]] std::string load_name(const layout::LoadRecord& load);

/// "m/s^2" or "Pa": the unit of a load of a layout::LoadKind; empty if it is none. Offline only.
[[nodiscard]] std::string_view load_unit(std::uint32_t kind);

/// "section_checksum": the rule's name as in VerifyRule. Offline only.
[[nodiscard]] std::string_view rule_name(VerifyRule rule);

/// One sentence for people: the section, field, index, value and limit of the first fault, and how to mend the file.
/// Offline only.
[[nodiscard]] std::string describe(const VerifyResult& result);

}  // namespace greenloop
