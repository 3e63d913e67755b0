#include "formats/verify/section_table.hpp"

#include <algorithm>
#include <cstring>

#include "formats/verify/crc32c.hpp"

namespace greenloop {
namespace {

using layout::SectionEntry;
using layout::SectionKind;

constexpr Section whole_file{};

bool is_same(const SectionEntry& entry, SectionKind kind, std::uint32_t a, std::uint32_t b) {
  return entry.kind == static_cast<std::uint32_t>(kind) && entry.a == a && entry.b == b;
}

// about entry i of the table
bool refuse_entry(VerifyResult& result, VerifyRule rule, const SectionEntry& entry, const char* field, std::uint32_t i,
                  double value, double limit) {
  result = {rule, static_cast<SectionKind>(entry.kind), entry.a, entry.b, field, i, value, limit};
  return false;
}

}  // namespace

const SectionEntry* SectionTable::entries() const {
  return reinterpret_cast<const SectionEntry*>(file_.data() + sizeof(layout::Header));
}

std::span<const std::byte> SectionTable::part(std::uint64_t offset, std::uint64_t bytes) const {
  return file_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(bytes));
}

bool SectionTable::check_header(VerifyResult& result) const {
  SectionCheck check(whole_file, result);
  const auto address = reinterpret_cast<std::uintptr_t>(file_.data());
  if (!check.require(address % layout::alignment == 0, VerifyRule::misaligned_memory, "address", 0,
                     static_cast<double>(address % layout::alignment), 0) ||
      !check.require(file_.size() >= sizeof(layout::Header), VerifyRule::too_short, "bytes", 0,
                     static_cast<double>(file_.size()), sizeof(layout::Header))) {
    return false;
  }
  const layout::Header& h = header();
  const auto size = static_cast<double>(file_.size());
  const std::uint32_t crc = crc32c(file_.first(offsetof(layout::Header, header_crc)));
  for (std::size_t i = 0; i < sizeof(h.magic); ++i) {
    if (h.magic[i] != layout::magic[i]) {
      return check.refuse(VerifyRule::bad_magic, "magic", i, static_cast<unsigned char>(h.magic[i]),
                          static_cast<unsigned char>(layout::magic[i]));
    }
  }
  return check.require(h.endian == layout::endian_tag, VerifyRule::foreign_endianness, "endian", 0, h.endian,
                       layout::endian_tag) &&
         check.require(h.major == layout::version_major, VerifyRule::unsupported_major, "major", 0, h.major,
                       layout::version_major) &&
         check.require(h.file_bytes == file_.size() && file_.size() % layout::alignment == 0, VerifyRule::wrong_length,
                       "file_bytes", 0, static_cast<double>(h.file_bytes), size) &&
         check.require(h.header_crc == crc, VerifyRule::header_checksum, "header_crc", 0, h.header_crc, crc) &&
         check.require(!reserved_is_zero() || all_zero(std::as_bytes(std::span(h.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0) &&
         check.require(h.levels >= 1 && h.levels <= layout::max_levels, VerifyRule::out_of_range, "levels", 0, h.levels,
                       layout::max_levels);
}

bool SectionTable::check_padding(std::uint64_t begin, std::uint64_t end, VerifyResult& result) const {
  const auto gap = part(begin, end - begin);
  if (all_zero(gap)) return true;
  const auto first = std::find_if(gap.begin(), gap.end(), [](std::byte byte) { return byte != std::byte{0}; });
  return SectionCheck(whole_file, result)
      .refuse(VerifyRule::padding_not_zero, "padding", begin + static_cast<std::uint64_t>(first - gap.begin()),
              std::to_integer<int>(*first), 0);
}

bool SectionTable::check_entry(std::uint32_t i, std::uint64_t end_of_previous, VerifyResult& result) const {
  const SectionEntry& entry = entries()[i];
  const auto refuse = [&](VerifyRule rule, const char* field, std::uint64_t value, std::uint64_t limit) {
    return refuse_entry(result, rule, entry, field, i, static_cast<double>(value), static_cast<double>(limit));
  };
  if (reserved_is_zero()) {
    if (!layout::is_section_kind(entry.kind) ||
        layout::first_minor(static_cast<SectionKind>(entry.kind)) > header().minor) {
      return refuse(VerifyRule::bad_enum, "section.kind", entry.kind, layout::last_section_kind());
    }
    if (entry.reserved != 0) return refuse(VerifyRule::reserved_not_zero, "section.reserved", entry.reserved, 0);
  }
  if (entry.offset % layout::alignment != 0) {
    return refuse(VerifyRule::section_misaligned, "section.offset", entry.offset, layout::alignment);
  }
  if (entry.offset > file_.size()) {
    return refuse(VerifyRule::section_out_of_bounds, "section.offset", entry.offset, file_.size());
  }
  if (entry.bytes > file_.size() - entry.offset) {
    return refuse(VerifyRule::section_out_of_bounds, "section.bytes", entry.bytes, file_.size() - entry.offset);
  }
  if (entry.offset < end_of_previous) {
    return refuse(VerifyRule::section_overlap, "section.offset", entry.offset, end_of_previous);
  }
  const std::uint32_t crc = crc32c(part(entry.offset, entry.bytes));
  if (entry.crc != crc) return refuse(VerifyRule::section_checksum, "section.crc", entry.crc, crc);
  return true;
}

bool SectionTable::check_entries(VerifyResult& result) const {
  SectionCheck check(whole_file, result);
  const std::uint64_t room = (file_.size() - sizeof(layout::Header)) / sizeof(SectionEntry);
  if (!check.require(count() <= room, VerifyRule::section_out_of_bounds, "section_count", 0, count(),
                     static_cast<double>(room))) {
    return false;
  }
  const std::uint64_t table_bytes = std::uint64_t{count()} * sizeof(SectionEntry);
  const std::uint32_t crc = crc32c(part(sizeof(layout::Header), table_bytes));
  if (!check.require(header().table_crc == crc, VerifyRule::table_checksum, "table_crc", 0, header().table_crc, crc)) {
    return false;
  }
  std::uint64_t end = sizeof(layout::Header) + table_bytes;
  for (std::uint32_t i = 0; i < count(); ++i) {
    if (!check_entry(i, end, result) || !check_padding(end, entries()[i].offset, result)) return false;
    end = entries()[i].offset + entries()[i].bytes;
  }
  // what follows the last section fills it up to the alignment, no more
  return check.require(file_.size() - end < layout::alignment, VerifyRule::wrong_length, "file_bytes", 0,
                       static_cast<double>(file_.size()), static_cast<double>(end)) &&
         check_padding(end, file_.size(), result);
}

void SectionTable::skip_unknown() {
  while (next_ < count() && !layout::is_section_kind(entries()[next_].kind)) ++next_;
}

bool SectionTable::is_next(SectionKind kind) {
  skip_unknown();
  return next_ < count() && entries()[next_].kind == static_cast<std::uint32_t>(kind);
}

bool SectionTable::take(SectionKind kind, std::uint32_t a, std::uint32_t b, Section& section, VerifyResult& result) {
  skip_unknown();
  if (next_ < count() && is_same(entries()[next_], kind, a, b)) {
    const SectionEntry& entry = entries()[next_++];
    section = {kind, entry.a, entry.b, file_.data() + entry.offset, entry.bytes};
    return true;
  }
  // tell a section that stands twice, or at the wrong place, from one that is absent
  const bool comes_later = std::any_of(entries() + next_, entries() + count(),
                                       [&](const SectionEntry& entry) { return is_same(entry, kind, a, b); });
  if (comes_later || (next_ < count() && stood_before(next_))) return refuse_next(result);
  result = {VerifyRule::section_missing,   kind,      static_cast<std::uint16_t>(a),
            static_cast<std::uint16_t>(b), "section", next_,
            static_cast<double>(count()),  0};
  return false;
}

bool SectionTable::stood_before(std::uint32_t i) const {
  const SectionEntry& entry = entries()[i];
  return std::any_of(entries(), entries() + i, [&](const SectionEntry& earlier) {
    return is_same(earlier, static_cast<SectionKind>(entry.kind), entry.a, entry.b);
  });
}

bool SectionTable::refuse_next(VerifyResult& result) const {
  const VerifyRule rule = stood_before(next_) ? VerifyRule::section_duplicate : VerifyRule::section_order;
  return refuse_entry(result, rule, entries()[next_], "section", next_, next_, 0);
}

bool SectionTable::finish(VerifyResult& result) {
  skip_unknown();
  return next_ == count() || refuse_next(result);
}

}  // namespace greenloop
