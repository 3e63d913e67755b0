#include "formats/verify.hpp"

#include "formats/section_table.hpp"
#include "formats/verify_sections.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;

// The sections of a file in the one order layout.hpp allows.
class SectionWalk {
 public:
  SectionWalk(SectionTable& table, VerifyContext& context) : table_(table), context_(context) {}

  bool whole_file() {
    if (!next(SectionKind::info, 0, 0, verify_info) || !next(SectionKind::provenance, 0, 0, verify_provenance)) {
      return false;
    }
    for (std::uint32_t q = 0; q < table_.header().levels; ++q) {
      if (!level(q)) return false;
    }
    return table_.finish(context_.result) && verify_counts(context_);
  }

 private:
  using Verify = bool (*)(const Section&, VerifyContext&);

  bool next(SectionKind kind, std::uint32_t a, std::uint32_t b, Verify verify) {
    Section section;
    return table_.take(kind, a, b, section, context_.result) && verify(section, context_);
  }

  bool level(std::uint32_t q) {
    return next(SectionKind::level, q, 0, verify_level) && next(SectionKind::nodes, q, 0, verify_nodes) &&
           (q == 0 ? next(SectionKind::base_triangles, 0, 0, verify_base_triangles)
                   : next(SectionKind::refinement, q, 0, verify_refinement)) &&
           (!has_columns(q) || next(SectionKind::columns, q, 0, verify_columns)) &&
           per_constraint_level(q, SectionKind::representatives, verify_representatives) &&
           per_constraint_level(q, SectionKind::blocks, verify_blocks);
  }

  // (c, q) for c = 0..q, then (q, r) for r = 0..q-1, of the constraint levels that have columns
  bool per_constraint_level(std::uint32_t q, SectionKind kind, Verify verify) {
    for (std::uint32_t c = 0; c <= q; ++c) {
      if (has_columns(c) && !next(kind, c, q, verify)) return false;
    }
    for (std::uint32_t r = 0; r < q && has_columns(q); ++r) {
      if (!next(kind, q, r, verify)) return false;
    }
    return true;
  }

  [[nodiscard]] bool has_columns(std::uint32_t c) const { return context_.view.level[c].counts->column_count > 0; }

  SectionTable& table_;
  VerifyContext& context_;
};

}  // namespace

VerifyResult verify(std::span<const std::byte> bytes, ModelView& view) noexcept {
  VerifyResult result;
  view = {};
  SectionTable table(bytes);
  if (!table.check_header(result) || !table.check_entries(result)) return result;
  view.header = &table.header();
  VerifyContext context{view, result, table.reserved_is_zero(), {}};
  if (!SectionWalk(table, context).whole_file()) view = {};
  return result;
}

}  // namespace greenloop
