#include "formats/verify.hpp"

#include "formats/verify/elastostatic/walk.hpp"
#include "formats/verify/impulse_response/walk.hpp"
#include "formats/verify/multigrid/walk.hpp"
#include "formats/verify/section_table.hpp"

namespace greenloop {
namespace {

// Info begins alike whatever the problem; what follows is the problem's own.
bool verify_problem(const Section& info, SectionTable& table, ModelView& view, VerifyResult& result) {
  SectionCheck check(info, result);
  if (!check.require_bytes(sizeof(layout::InfoStart))) return false;
  const std::uint32_t problem = info.as<layout::InfoStart>()->problem;
  if (!check.require_enum("problem", problem, layout::problems_of(table.header().minor))) return false;
  view.problem = static_cast<layout::Problem>(problem);
  switch (view.problem) {
    case layout::Problem::elastostatic:
    case layout::Problem::scalar:
      return elastostatic::verify_sections(info, table, view, result);
    case layout::Problem::impulse_response:
      return impulse_response::verify_sections(info, table, view, result);
    case layout::Problem::multigrid:
      return multigrid::verify_sections(info, table, view, result);
  }
  return false;
}

bool verify_file(SectionTable& table, ModelView& view, VerifyResult& result) {
  if (!table.check_header(result) || !table.check_entries(result)) return false;
  view.header = &table.header();
  Section info;
  return table.take(layout::SectionKind::info, 0, 0, info, result) && verify_problem(info, table, view, result) &&
         table.finish(result);
}

}  // namespace

VerifyResult verify(std::span<const std::byte> bytes, ModelView& view) noexcept {
  VerifyResult result;
  view = {};
  SectionTable table(bytes);
  if (!verify_file(table, view, result)) view = {};
  return result;
}

}  // namespace greenloop
