#include "offline/scene/toml_letters.hpp"

#include <doctest/doctest.h>

#include "offline/scene/scene.hpp"

namespace greenloop::offline {
namespace {

TEST_CASE("letters beyond ASCII are found outside of strings and comments, with their place") {
  const auto found = unquoted_letter("a = 1\nb = \"é\" # ü\né = 2\n");
  REQUIRE(found);
  CHECK(found->line == 3);
  CHECK(found->column == 1);
  const auto behind = unquoted_letter("name = 'é' ö");
  REQUIRE(behind);
  CHECK(behind->column == 12);
  CHECK(unquoted_letter("a = 1\xc2\xa0"));
  CHECK(unquoted_letter("a = \"open\né = 1"));  // the string ends with its line
}

TEST_CASE("letters beyond ASCII may stand in every kind of string and in comments") {
  CHECK_FALSE(unquoted_letter("\xef\xbb\xbf# é\na = \"é\\\"é\"\nb = 'é'\n"));
  CHECK_FALSE(unquoted_letter("a = \"\"\"é\n\"é\n\"\"\"\nb = '''é\n'é'''\n'é' = 1"));
  CHECK_FALSE(unquoted_letter(""));
  CHECK_FALSE(unquoted_letter("a = \"\\"));
}

TEST_CASE("a scene with such a letter is refused with its place") {
  try {
    (void)parse_scene("[surface]\nfile = kühl.off\n", "s.toml");
    FAIL("accepted");
  } catch (const SceneError& error) {
    CHECK(std::string(error.what()).find("s.toml:2:9: a letter beyond ASCII stands outside of quotes") !=
          std::string::npos);
  }
}

}  // namespace
}  // namespace greenloop::offline
