#pragma once

#include <string>
#include <string_view>

namespace greenloop {

/// `text` as a terminal may have it: control bytes other than newline and tab become \x1b, control characters in UTF-8
/// \u009b, and what is no UTF-8 U+FFFD. Work: linear.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace greenloop
