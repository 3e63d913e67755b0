#pragma once

#include <optional>
#include <string_view>

namespace greenloop::offline {

/// A place in a text, both counted from 1; columns in characters of UTF-8.
struct TextPlace {
  unsigned line = 1, column = 1;
};

/// Where a character beyond ASCII first stands in a TOML text outside of strings and comments. TOML 1.0 has none there,
/// and toml++ 3.3 is undefined by them. Work: linear.
[[nodiscard]] std::optional<TextPlace> unquoted_letter(std::string_view text);

}  // namespace greenloop::offline
