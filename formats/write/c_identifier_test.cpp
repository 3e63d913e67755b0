#include "formats/write/c_identifier.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace greenloop;

TEST_CASE("C identifiers: a stem that may be a name is one") {
  for (const auto* const stem : {"bear", "small_sphere", "Bear2", "model", "switches", "_"}) {
    CAPTURE(stem);
    CHECK((identifier_from(stem) == stem) == (std::string_view(stem) != "_"));
  }
}

TEST_CASE("C identifiers: words that are taken get _model") {
  for (const auto* const stem :
       {"switch", "default", "register", "union", "class", "main", "printf", "size_t", "x_size", "uint8_t", "EOF"}) {
    CHECK(identifier_from(stem) == std::string(stem) + "_model");
  }
}

TEST_CASE("C identifiers: every stem has a name of its own, which is allowed") {
  std::set<std::string> names;
  const auto stems = {"a-b", "a_b",    "a b",          "a.b",     "a--b",         "a__b",
                      "_a",  "__a",    "a_",           "a_model", "3d",           "model_3d",
                      "",    "-",      "\xc3\xa9",     "switch",  "switch_model", "switch_model_model",
                      "a",   "a_size", "a_size_model", "b",       "model"};
  for (const std::string stem : stems) {
    CAPTURE(stem);
    const auto name = identifier_from(stem);
    CAPTURE(name);
    CHECK(is_identifier(name));
    CHECK(name.find("__") == std::string::npos);
    CHECK(name.front() != '_');
    CHECK(names.insert(name).second);
    CHECK(names.insert(name + "_size").second);
  }
}
