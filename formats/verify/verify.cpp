#include "formats/verify.hpp"

#include "formats/verify/section_table.hpp"
#include "formats/verify/verify_sections.hpp"

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
    return table_.finish(context_.result);
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
           stencils(q) && predictions(q) && representatives(q) && next(SectionKind::scales, q, 0, verify_scales) &&
           couplings(q) && patterns(q) && verify_counts(q, context_);
  }

  bool stencils(std::uint32_t q) {
    const auto wavelet = static_cast<layout::Wavelet>(context_.view.info->wavelet);
    return q == 0 || !layout::is_butterfly(wavelet) || next(SectionKind::stencils, q, 0, verify_stencils);
  }

  bool predictions(std::uint32_t q) {
    const auto wavelet = static_cast<layout::Wavelet>(context_.view.info->wavelet);
    return q == 0 || wavelet != layout::Wavelet::equilibrated ||
           next(SectionKind::predictions, q, 0, verify_predictions);
  }

  // (c, q) for c = first..q, then (q, r) for r = 0..q-1, of the constraint levels that contacts may be resolved on
  bool representatives(std::uint32_t q) {
    const std::uint32_t first = context_.view.info->coarsest_constraint_level;
    for (std::uint32_t c = first; c <= q; ++c) {
      if (!next(SectionKind::representatives, c, q, verify_representatives)) return false;
    }
    for (std::uint32_t r = 0; r < q && q >= first; ++r) {
      if (!next(SectionKind::representatives, q, r, verify_representatives)) return false;
    }
    return true;
  }

  bool couplings(std::uint32_t q) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      if (!next(SectionKind::couplings, q, layer, verify_couplings)) return false;
    }
    return true;
  }

  bool patterns(std::uint32_t q) {
    return q < context_.view.info->coarsest_constraint_level || next(SectionKind::patterns, q, 0, verify_patterns);
  }

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
