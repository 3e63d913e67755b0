#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop {

/// JSON from outside is nested at most so deeply: readers of JSON recurse.
inline constexpr std::uint32_t most_nesting = 64;

/// The place of the first bracket or brace of `text` that opens more than `most` levels, whether or not the rest is
/// JSON; the length of the text if there is none. Work: linear. No heap, no exception.
[[nodiscard]] constexpr std::size_t first_nested_deeper(std::span<const std::byte> text, std::uint32_t most) noexcept {
  std::uint32_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char at = static_cast<char>(text[i]);
    if (in_string) {
      if (at == '\\') ++i;
      in_string = at != '"';
    } else if (at == '"') {
      in_string = true;
    } else if (at == '[' || at == '{') {
      if (depth == most) return i;
      ++depth;
    } else if ((at == ']' || at == '}') && depth > 0) {
      --depth;
    }
  }
  return text.size();
}

}  // namespace greenloop
