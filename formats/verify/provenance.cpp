#include "formats/verify/provenance.hpp"

#include "formats/verify/nesting.hpp"

namespace greenloop {
namespace {

// Bytes of the UTF-8 sequence that `text` starts with; 0 if there is none (Unicode, table 3-7).
std::size_t utf8_length(std::span<const std::byte> text) {
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(text[i]); };
  const std::uint32_t lead = at(0);
  if (lead < 0x80) return lead == 0 ? 0 : 1;
  const std::size_t length = lead >= 0xC2 && lead < 0xE0 ? 2 : lead >= 0xE0 && lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (lead < 0xC2 || length == 0 || length > text.size()) return 0;
  const std::uint32_t second_low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const std::uint32_t second_high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (at(1) < second_low || at(1) > second_high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (at(i) < 0x80 || at(i) > 0xBF) return 0;
  }
  return length;
}

}  // namespace

bool verify_provenance(SectionTable& table, FileView& view, VerifyResult& result) {
  Section section;
  if (!table.take(layout::SectionKind::provenance, 0, 0, section, result)) return false;
  SectionCheck check(section, result);
  const std::span text(section.data, static_cast<std::size_t>(section.bytes));
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text.subspan(i));
    if (!check.require(length > 0, VerifyRule::out_of_range, "text", i, std::to_integer<int>(text[i]), 0)) return false;
    i += length;
  }
  const std::size_t deeper = first_nested_deeper(text, most_nesting);
  if (!check.require(deeper == text.size(), VerifyRule::out_of_range, "nesting", deeper, most_nesting + 1.0,
                     most_nesting)) {
    return false;
  }
  view.provenance = {section.as<char>(), text.size()};
  return true;
}

}  // namespace greenloop
