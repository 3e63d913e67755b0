#pragma once

#include "formats/verify.hpp"

namespace greenloop {

/// What a rule of the verifier means, for people; static storage.
struct RuleText {
  VerifyRule rule;
  const char* name;     ///< as in VerifyRule
  const char* meaning;  ///< what is wrong
  const char* mend;     ///< how to mend it
};

namespace detail {
inline constexpr const char* rebuild = "build the model again, or ask the program that wrote it for a correction";
inline constexpr const char* fetch_again = "the file was damaged or cut in transit: copy it again or build it again";
inline constexpr const char* align = "place the file's bytes at a 64-byte boundary (load_file does)";
inline constexpr const char* wrong_file = "name a .gloop file made by `greenloop build`";

inline constexpr RuleText rule_texts[] = {
    {VerifyRule::ok, "ok", "the file is valid", ""},
    {VerifyRule::misaligned_memory, "misaligned_memory", "the memory is not 64-byte aligned", align},
    {VerifyRule::too_short, "too_short", "the file is shorter than a header", fetch_again},
    {VerifyRule::bad_magic, "bad_magic", "this is not a model file", wrong_file},
    {VerifyRule::foreign_endianness, "foreign_endianness", "the byte order is not little-endian",
     "build the model on, and read it with, a little-endian machine"},
    {VerifyRule::unsupported_major, "unsupported_major", "the file's major version is not this reader's",
     "build the model again with this release, or use the release that wrote it"},
    {VerifyRule::wrong_length, "wrong_length", "the length is not the one the header states", fetch_again},
    {VerifyRule::header_checksum, "header_checksum", "the header's checksum does not match", fetch_again},
    {VerifyRule::table_checksum, "table_checksum", "the section table's checksum does not match", fetch_again},
    {VerifyRule::section_out_of_bounds, "section_out_of_bounds", "a section reaches past the end of the file", rebuild},
    {VerifyRule::section_misaligned, "section_misaligned", "a section does not start at a multiple of 64", rebuild},
    {VerifyRule::section_overlap, "section_overlap", "a section starts before the one ahead of it ends", rebuild},
    {VerifyRule::section_order, "section_order", "a section stands where another one belongs", rebuild},
    {VerifyRule::section_missing, "section_missing", "a section is missing", rebuild},
    {VerifyRule::section_duplicate, "section_duplicate", "a section stands twice", rebuild},
    {VerifyRule::section_size, "section_size", "a section's size does not follow from its counts", rebuild},
    {VerifyRule::section_checksum, "section_checksum", "a section's checksum does not match", fetch_again},
    {VerifyRule::padding_not_zero, "padding_not_zero", "bytes between sections or arrays are not zero", rebuild},
    {VerifyRule::reserved_not_zero, "reserved_not_zero", "reserved bytes are not zero", rebuild},
    {VerifyRule::bad_enum, "bad_enum", "a value is none of those defined", rebuild},
    {VerifyRule::out_of_range, "out_of_range", "a value is out of range", rebuild},
    {VerifyRule::not_finite, "not_finite", "a number is not finite", rebuild},
    {VerifyRule::not_increasing, "not_increasing", "values do not increase", rebuild},
    {VerifyRule::inconsistent, "inconsistent", "two parts of the file contradict each other", rebuild},
};
}  // namespace detail

/// The text of a rule; that of the last one for a number that is none. At most one comparison per rule.
[[nodiscard]] constexpr const RuleText& rule_text(VerifyRule rule) {
  const RuleText* at = detail::rule_texts;
  while (at->rule != rule && at->rule != VerifyRule::inconsistent) {
    ++at;
  }
  return *at;
}

}  // namespace greenloop
