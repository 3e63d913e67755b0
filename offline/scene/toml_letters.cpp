#include "offline/scene/toml_letters.hpp"

#include <algorithm>
#include <cstddef>

namespace greenloop::offline {
namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

// behind a string that begins at `at`, or at the end of its line if it does not end there
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool several_lines = text.substr(at, 3) == std::string_view(quote == '"' ? "\"\"\"" : "'''");
  const std::string_view close = text.substr(at, several_lines ? 3 : 1);
  at += close.size();
  while (at < text.size() && text.substr(at, close.size()) != close) {
    if (!several_lines && text[at] == '\n') return at;
    at += quote == '"' && text[at] == '\\' ? 2 : 1;
  }
  return std::min(at + close.size(), text.size());
}

TextPlace place_of(std::string_view text, std::size_t at) {
  TextPlace place;
  for (const char c : text.substr(0, at)) {
    if (c == '\n') {
      place = {place.line + 1, 1};
    } else if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) {
      ++place.column;
    }
  }
  return place;
}

}  // namespace

std::optional<TextPlace> unquoted_letter(std::string_view text) {
  std::size_t at = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  while (at < text.size()) {
    if (text[at] == '"' || text[at] == '\'') {
      at = end_of_string(text, at);
    } else if (text[at] == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (static_cast<unsigned char>(text[at]) > 0x7f) {
      return place_of(text, at);
    } else {
      ++at;
    }
  }
  return std::nullopt;
}

}  // namespace greenloop::offline
