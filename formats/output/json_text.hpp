#pragma once

#include <string>

namespace greenloop {

/// JSON text of any nlohmann value, for files and terminals: what is no UTF-8, as a file's name may be, becomes U+FFFD,
/// and there are no control characters. `indent` < 0: on one line. The one way that programs write JSON.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = 2) {
  const std::string dumped = json.dump(indent, ' ', false, Json::error_handler_t::replace);
  std::string text;
  text.reserve(dumped.size());
  for (std::size_t i = 0; i < dumped.size(); ++i) {
    const auto byte = static_cast<unsigned char>(dumped[i]);
    const auto next = i + 1 < dumped.size() ? static_cast<unsigned char>(dumped[i + 1]) : 0U;
    if (byte == 0x7F) {
      text += "\\u007f";
    } else if (byte == 0xC2 && next < 0xA0) {  // U+0080 to U+009F, which JSON leaves as they are
      constexpr const char* digits = "0123456789abcdef";
      text += {'\\', 'u', '0', '0', digits[next >> 4U], digits[next & 0xFU]};
      ++i;
    } else {
      text += dumped[i];
    }
  }
  return text;
}

}  // namespace greenloop
