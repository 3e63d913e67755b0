#pragma once

#include <string_view>

namespace greenloop {

/// Throws std::runtime_error("<what>: ...") if `text` is nested more deeply than a reader of JSON may follow. To be
/// called before JSON from outside is parsed. Work: linear.
void require_shallow(std::string_view text, std::string_view what);

/// Whether it is not.
[[nodiscard]] bool is_shallow(std::string_view text);

}  // namespace greenloop
