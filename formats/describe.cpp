#include "formats/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace greenloop {
namespace {

using layout::SectionKind;

constexpr std::string_view rebuild = "build the model again, or ask the program that wrote it for a correction";
constexpr std::string_view fetch_again = "the file was damaged or cut in transit: copy it again or build it again";
constexpr std::string_view align = "place the file's bytes at a 64-byte boundary (load_file does)";
constexpr std::string_view wrong_file = "name a .gloop file made by `greenloop build`";

struct RuleText {
  VerifyRule rule;
  std::string_view name, meaning, mend;
};

constexpr std::array rules{
    RuleText{VerifyRule::ok, "ok", "the file is valid", ""},
    RuleText{VerifyRule::misaligned_memory, "misaligned_memory", "the memory is not 64-byte aligned", align},
    RuleText{VerifyRule::too_short, "too_short", "the file is shorter than a header", fetch_again},
    RuleText{VerifyRule::bad_magic, "bad_magic", "this is not a model file", wrong_file},
    RuleText{VerifyRule::foreign_endianness, "foreign_endianness", "the byte order is not little-endian",
             "build the model on, and read it with, a little-endian machine"},
    RuleText{VerifyRule::unsupported_major, "unsupported_major", "the file's major version is not this reader's",
             "build the model again with this release, or use the release that wrote it"},
    RuleText{VerifyRule::wrong_length, "wrong_length", "the length is not the one the header states", fetch_again},
    RuleText{VerifyRule::header_checksum, "header_checksum", "the header's checksum does not match", fetch_again},
    RuleText{VerifyRule::table_checksum, "table_checksum", "the section table's checksum does not match", fetch_again},
    RuleText{VerifyRule::section_out_of_bounds, "section_out_of_bounds", "a section reaches past the end of the file",
             rebuild},
    RuleText{VerifyRule::section_misaligned, "section_misaligned", "a section does not start at a multiple of 64",
             rebuild},
    RuleText{VerifyRule::section_overlap, "section_overlap", "a section starts before the one ahead of it ends",
             rebuild},
    RuleText{VerifyRule::section_order, "section_order", "a section stands where another one belongs", rebuild},
    RuleText{VerifyRule::section_missing, "section_missing", "a section is missing", rebuild},
    RuleText{VerifyRule::section_duplicate, "section_duplicate", "a section stands twice", rebuild},
    RuleText{VerifyRule::section_size, "section_size", "a section's size does not follow from its counts", rebuild},
    RuleText{VerifyRule::section_checksum, "section_checksum", "a section's checksum does not match", fetch_again},
    RuleText{VerifyRule::padding_not_zero, "padding_not_zero", "bytes between sections or arrays are not zero",
             rebuild},
    RuleText{VerifyRule::reserved_not_zero, "reserved_not_zero", "reserved bytes are not zero", rebuild},
    RuleText{VerifyRule::bad_enum, "bad_enum", "a value is none of those defined", rebuild},
    RuleText{VerifyRule::out_of_range, "out_of_range", "a value is out of range", rebuild},
    RuleText{VerifyRule::not_finite, "not_finite", "a number is not finite", rebuild},
    RuleText{VerifyRule::not_increasing, "not_increasing", "values do not increase", rebuild},
    RuleText{VerifyRule::inconsistent, "inconsistent", "two parts of the file contradict each other", rebuild},
};

const RuleText& text_of(VerifyRule rule) {
  return *std::find_if(rules.begin(), rules.end() - 1, [&](const RuleText& text) { return text.rule == rule; });
}

std::string place(const VerifyResult& result) {
  const bool in_section = result.kind != SectionKind{};
  const std::string where = in_section ? section_name(result.kind, result.a, result.b) : "the header";
  return fmt::format("{}, field `{}`, index {}", where, result.field, result.index);
}

}  // namespace

std::string section_name(SectionKind kind, std::uint32_t a, std::uint32_t b) {
  switch (kind) {
    case SectionKind::info:
      return "Info";
    case SectionKind::provenance:
      return "Provenance";
    case SectionKind::level:
      return fmt::format("Level({})", a);
    case SectionKind::nodes:
      return fmt::format("Nodes({})", a);
    case SectionKind::base_triangles:
      return "BaseTriangles";
    case SectionKind::refinement:
      return fmt::format("Refinement({})", a);
    case SectionKind::stencils:
      return fmt::format("Stencils({})", a);
    case SectionKind::representatives:
      return fmt::format("Representatives({}, {})", a, b);
    case SectionKind::scales:
      return fmt::format("Scales({})", a);
    case SectionKind::couplings:
      return fmt::format("Couplings({}, {})", a, b);
  }
  return fmt::format("section of kind {} ({}, {})", static_cast<std::uint32_t>(kind), a, b);
}

std::string_view wavelet_name(std::uint32_t wavelet) {
  switch (static_cast<layout::Wavelet>(wavelet)) {
    case layout::Wavelet::lifted_linear:
      return "lifted linear";
    case layout::Wavelet::linear:
      return "linear";
    case layout::Wavelet::lifted_butterfly:
      return "lifted butterfly";
    case layout::Wavelet::butterfly:
      return "butterfly";
  }
  return "unknown";
}

std::string_view rule_name(VerifyRule rule) { return text_of(rule).name; }

std::string describe(const VerifyResult& result) {
  const RuleText& text = text_of(result.rule);
  if (result.ok()) return std::string(text.meaning);
  return fmt::format("{}: {}: found {}, expected or limit {} ({}); {}.", place(result), text.meaning, result.value,
                     result.limit, text.name, text.mend);
}

}  // namespace greenloop
