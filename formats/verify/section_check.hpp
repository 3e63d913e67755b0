#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/verify.hpp"

namespace greenloop {

/// One section of a file whose table is right: inside the file, aligned, checksum checked.
struct Section {
  layout::SectionKind kind = {};
  std::uint16_t a = 0, b = 0;
  const std::byte* data = nullptr;
  std::uint64_t bytes = 0;

  template <class Record>
  [[nodiscard]] const Record* as() const {
    return reinterpret_cast<const Record*>(data);
  }
};

/// Writes down what is wrong with one section. Each function returns whether all is well, so that checks chain by &&.
class SectionCheck {
 public:
  SectionCheck(const Section& section, VerifyResult& result) : section_(section), result_(result) {}

  bool refuse(VerifyRule rule, const char* field, std::uint64_t index, double value, double limit) {
    result_ = {rule, section_.kind, section_.a, section_.b, field, index, value, limit};
    return false;
  }
  bool require(bool right, VerifyRule rule, const char* field, std::uint64_t index, double value, double limit) {
    return right || refuse(rule, field, index, value, limit);
  }

  /// As many elements as that, of the length that the table of section kinds states.
  bool require_count(std::uint64_t count) {
    // a 32-bit count times a small constant: no overflow
    const std::uint64_t expected = count * layout::element_bytes(section_.kind);
    return require(section_.bytes == expected, VerifyRule::section_size, "bytes", 0,
                   static_cast<double>(section_.bytes), static_cast<double>(expected));
  }
  /// At least so many bytes.
  bool require_bytes(std::uint64_t least) {
    return require(section_.bytes >= least, VerifyRule::section_size, "bytes", 0, static_cast<double>(section_.bytes),
                   static_cast<double>(least));
  }

  bool require_finite(const char* field, std::uint64_t index, double value) {
    return require(std::isfinite(value), VerifyRule::not_finite, field, index, value, 0);
  }
  bool require_above(const char* field, std::uint64_t index, double value, double limit) {
    return require_finite(field, index, value) &&
           require(value > limit, VerifyRule::out_of_range, field, index, value, limit);
  }
  bool require_at_least(const char* field, std::uint64_t index, double value, double limit) {
    return require_finite(field, index, value) &&
           require(value >= limit, VerifyRule::out_of_range, field, index, value, limit);
  }
  bool require_at_most(const char* field, std::uint64_t index, double value, double limit) {
    return require(value <= limit, VerifyRule::out_of_range, field, index, value, limit);
  }
  bool require_equal(const char* field, std::uint64_t index, double value, double limit) {
    return require(value == limit, VerifyRule::inconsistent, field, index, value, limit);
  }
  /// One of an enumeration whose values are 1 .. last.
  bool require_enum(const char* field, std::uint32_t value, std::uint32_t last) {
    return require(value >= 1 && value <= last, VerifyRule::bad_enum, field, 0, value, last);
  }

  /// An offset that its own header states.
  bool require_offset(const char* field, std::uint64_t offset, std::uint64_t expected) {
    return require(offset == expected, VerifyRule::inconsistent, field, 0, static_cast<double>(offset),
                   static_cast<double>(expected));
  }

  /// Bytes begin..end-1 of the section.
  bool require_zero(std::uint64_t begin, std::uint64_t end);

 private:
  const Section& section_;
  VerifyResult& result_;
};

/// True if every byte is zero. Work: linear.
[[nodiscard]] bool all_zero(std::span<const std::byte> bytes);

}  // namespace greenloop
