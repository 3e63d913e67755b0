#include "formats/output/printable.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>

namespace greenloop {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";

unsigned byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

struct Lead {
  std::size_t length;  ///< of the character in bytes; 0: none begins so
  unsigned bits;       ///< of its number that the first byte has
  unsigned least;      ///< number that takes so many bytes
};

Lead lead_of(unsigned byte) {
  if (byte < 0x80) return {1, byte, 0};
  if (byte >= 0xC2 && byte < 0xE0) return {2, byte & 0x1FU, 0x80};
  if (byte >= 0xE0 && byte < 0xF0) return {3, byte & 0x0FU, 0x800};
  if (byte >= 0xF0 && byte < 0xF5) return {4, byte & 0x07U, 0x10000};
  return {0, 0, 0};
}

/// The bytes of the UTF-8 character that `text` begins with, and its number; length 0: none.
Lead character_of(std::string_view text) {
  const Lead lead = lead_of(byte_at(text, 0));
  if (lead.length > text.size()) return {0, 0, 0};
  unsigned number = lead.bits;
  for (std::size_t i = 1; i < lead.length; ++i) {
    if ((byte_at(text, i) & 0xC0U) != 0x80) return {0, 0, 0};
    number = number << 6U | (byte_at(text, i) & 0x3FU);
  }
  const bool surrogate = number >= 0xD800 && number < 0xE000;
  if (number < lead.least || number > 0x10FFFF || surrogate) return {0, 0, 0};
  return {lead.length, number, lead.least};
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const auto [length, number, least] = character_of(text);
    const bool layout = number == '\n' || number == '\t';
    if (length == 0) {
      shown += replacement;
    } else if (length == 1 && (number < 0x20 || number == 0x7F) && !layout) {
      fmt::format_to(std::back_inserter(shown), "\\x{:02x}", number);
    } else if (length == 2 && number < 0xA0) {
      fmt::format_to(std::back_inserter(shown), "\\u{:04x}", number);
    } else {
      shown += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return shown;
}

}  // namespace greenloop
