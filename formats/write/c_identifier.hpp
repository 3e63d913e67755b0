#pragma once

#include <string>
#include <string_view>

namespace greenloop {

/// True for letters, digits and underscores that do not begin with a digit.
[[nodiscard]] bool is_identifier(std::string_view name);

/// What an array made of a file with this stem may be called in C and C++, different for different stems: the stem
/// itself where that is allowed. A word that C, C++ or their libraries have taken, one that ends in "_t" as their types
/// do, and one that ends in "_size" as the name of another array's length may, gets "_model" behind it. For characters
/// that no name may hold underscores are written, and eight hexadecimal digits made of the whole stem follow.
[[nodiscard]] std::string identifier_from(std::string_view stem);

}  // namespace greenloop
