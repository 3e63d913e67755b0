#pragma once

#include <doctest/doctest.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "offline/scene/scene.hpp"

namespace greenloop::offline::test {

inline const std::string smallest =
    "[surface]\nfile = \"bear.off\"\nunit = \"cm\"\n"  // lines 1 to 3
    "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"  // lines 4 to 6
    "[[fixed]]\nbelow = 0.1\naxis = \"y\"\n";          // lines 7 to 9

inline std::string with(std::string_view from, std::string_view to) {
  const auto at = smallest.find(from);
  REQUIRE(at != std::string::npos);
  return std::string(smallest).replace(at, from.size(), to);
}

inline std::vector<std::string> problems_of(const std::string& text) {
  try {
    static_cast<void>(parse_scene(text, "models/scene.toml"));
  } catch (const SceneError& error) {
    return error.problems();
  }
  return {};
}

/// Exactly one problem, with all of these pieces in its message.
inline void check_refused(const std::string& text, std::initializer_list<std::string_view> pieces) {
  const auto problems = problems_of(text);
  REQUIRE_MESSAGE(problems.size() == 1, text);
  CAPTURE(problems[0]);
  for (const auto piece : pieces) {
    CAPTURE(piece);
    CHECK(problems[0].find(piece) != std::string::npos);
  }
}

}  // namespace greenloop::offline::test
