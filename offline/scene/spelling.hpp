#pragma once

#include <span>
#include <string>
#include <string_view>

namespace greenloop::offline {

/// The valid word that needs the fewest changed letters (a change of case counts half), the first of equals; "" if
/// more than half of the word would have to change. Work: product of the lengths for each valid word.
[[nodiscard]] std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> valid);

/// " (did you mean \"young\"?)" for the nearest spelling, "" if there is none.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string_view> valid);

/// "a, b, c"
[[nodiscard]] std::string comma_list(std::span<const std::string_view> words);

}  // namespace greenloop::offline
