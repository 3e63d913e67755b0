#pragma once

#include <doctest/doctest.h>

#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/write/describe.hpp"

namespace greenloop {

/// Checks that `result` names exactly this rule and place, and that its sentence says so too.
inline void check_refusal(const VerifyResult& result, VerifyRule rule, layout::SectionKind kind, std::uint32_t a,
                          std::uint32_t b, const std::string& field, std::uint64_t index) {
  const std::string sentence = describe(result);
  CAPTURE(sentence);
  CHECK(rule_name(result.rule) == rule_name(rule));
  CHECK(section_name(result.kind, result.a, result.b) == section_name(kind, a, b));
  CHECK(result.field == field);
  CHECK(result.index == index);
  const std::string where = kind == layout::SectionKind{} ? "the header" : section_name(kind, a, b);
  CHECK(sentence.find(where) == 0);
  CHECK(sentence.find("`" + field + "`, index " + std::to_string(index)) != std::string::npos);
  CHECK(sentence.find(rule_name(rule)) != std::string::npos);
}

/// Checks that the broken file is refused so, and that no view of it is handed out.
inline void check_refused(ModelMutant& mutant, VerifyRule rule, layout::SectionKind kind, std::uint32_t a,
                          std::uint32_t b, const std::string& field, std::uint64_t index) {
  check_refusal(mutant.verdict(), rule, kind, a, b, field, index);
  CHECK(mutant.view().header == nullptr);
  CHECK(mutant.view().levels == 0);
}

}  // namespace greenloop
