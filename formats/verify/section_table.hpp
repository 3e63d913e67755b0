#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/verify.hpp"
#include "formats/verify/section_check.hpp"

namespace greenloop {

/// The section table of a model file, read in file order.
class SectionTable {
 public:
  explicit SectionTable(std::span<const std::byte> file) : file_(file) {}

  /// Verifies the header; nothing else may be called before. Work: constant.
  bool check_header(VerifyResult& result) const;

  /// Verifies every entry, its checksum and all padding. Work: linear in the file.
  bool check_entries(VerifyResult& result) const;

  /// The next section of a known kind, which must be this one. Work: constant (linear in the table on refusal).
  bool take(layout::SectionKind kind, std::uint32_t a, std::uint32_t b, Section& section, VerifyResult& result);

  /// Whether the next section of a known kind is of this one: it need not be there. Work: constant.
  [[nodiscard]] bool is_next(layout::SectionKind kind);

  /// After the last section: nothing but unknown kinds may be left.
  bool finish(VerifyResult& result);

  [[nodiscard]] const layout::Header& header() const { return *reinterpret_cast<const layout::Header*>(file_.data()); }

  /// False if a newer minor version wrote the file: it may use what is reserved here.
  [[nodiscard]] bool reserved_is_zero() const { return header().minor <= layout::version_minor; }

 private:
  [[nodiscard]] std::uint32_t count() const { return header().section_count; }
  [[nodiscard]] std::span<const std::byte> part(std::uint64_t offset, std::uint64_t bytes) const;
  [[nodiscard]] const layout::SectionEntry* entries() const;
  [[nodiscard]] bool stood_before(std::uint32_t i) const;
  void skip_unknown();
  bool refuse_next(VerifyResult& result) const;
  bool check_padding(std::uint64_t begin, std::uint64_t end, VerifyResult& result) const;
  bool check_entry(std::uint32_t i, std::uint64_t end_of_previous, VerifyResult& result) const;

  std::span<const std::byte> file_;
  std::uint32_t next_ = 0;
};

}  // namespace greenloop
