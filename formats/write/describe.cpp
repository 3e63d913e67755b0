#include "formats/write/describe.hpp"

#include <fmt/format.h>

#include "formats/verify/rule_text.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;

std::string place(const VerifyResult& result) {
  const bool in_section = result.kind != SectionKind{};
  const std::string where = in_section ? section_name(result.kind, result.a, result.b) : "the header";
  return fmt::format("{}, field `{}`, index {}", where, result.field, result.index);
}

}  // namespace

std::string section_name(SectionKind kind, std::uint32_t a, std::uint32_t b) {
  for (const layout::SectionForm& form : layout::section_forms) {
    if (form.kind != kind) continue;
    if (form.indices == 0) return form.name;
    return form.indices == 1 ? fmt::format("{}({})", form.name, a) : fmt::format("{}({}, {})", form.name, a, b);
  }
  return fmt::format("section of kind {} ({}, {})", static_cast<std::uint32_t>(kind), a, b);
}

std::string_view problem_name(layout::Problem problem) {
  switch (problem) {
    case layout::Problem::elastostatic:
      return "elastostatic";
    case layout::Problem::scalar:
      return "scalar";
    case layout::Problem::impulse_response:
      return "impulse response";
    case layout::Problem::multigrid:
      return "multigrid";
  }
  return "unknown";
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
    case layout::Wavelet::equilibrated:
      return "equilibrated";
  }
  return "unknown";
}

std::string_view pattern_name(std::uint32_t kind) {
  switch (static_cast<layout::PatternKind>(kind)) {
    case layout::PatternKind::node:
      return "node";
    case layout::PatternKind::patch:
      return "patch";
    case layout::PatternKind::sphere:
      return "sphere";
    case layout::PatternKind::turned:
      return "turned";
    case layout::PatternKind::gathered:
      return "gathered";
    case layout::PatternKind::pinch:
      return "pinch";
    case layout::PatternKind::opposed:
      return "opposed";
    case layout::PatternKind::alternating:
      return "alternating";
    case layout::PatternKind::random:
      return "random";
  }
  return "unknown";
}

std::string load_name(const layout::LoadRecord& load) {
  switch (static_cast<layout::LoadKind>(load.kind)) {
    case layout::LoadKind::acceleration_x:
      return "acceleration along x";
    case layout::LoadKind::acceleration_y:
      return "acceleration along y";
    case layout::LoadKind::acceleration_z:
      return "acceleration along z";
    case layout::LoadKind::pressure:
      return load.name;
  }
  return "unknown";
}

std::string_view load_unit(std::uint32_t kind) {
  if (kind < 1 || kind > layout::load_kinds) return "";
  return static_cast<layout::LoadKind>(kind) == layout::LoadKind::pressure ? "Pa" : "m/s^2";
}

std::string_view rule_name(VerifyRule rule) { return rule_text(rule).name; }

std::string describe(const VerifyResult& result) {
  const RuleText& text = rule_text(result.rule);
  if (result.ok()) return std::string(text.meaning);
  return fmt::format("{}: {}: found {}, expected or limit {} ({}); {}.", place(result), text.meaning, result.value,
                     result.limit, text.name, text.mend);
}

}  // namespace greenloop
