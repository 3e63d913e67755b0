#include "offline/report/pattern_figures.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/synthetic_model.hpp"

namespace greenloop::offline {
namespace {

ModelMutant model_with(const std::vector<layout::PatternRecord>& patterns) {
  ModelData data = synthetic_model({.levels = 3, .coarsest_constraint_level = 1});
  for (std::size_t level : {1, 2}) data.levels[level].patterns = patterns;
  ModelMutant mutant(encode(data));
  REQUIRE(mutant.verdict().ok());
  return mutant;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

}  // namespace

TEST_CASE("patterns: none, no figure") {
  CHECK_FALSE(has_patterns(model_with({}).view()));
  CHECK(has_patterns(model_with(synthetic_patterns()).view()));
}

TEST_CASE("patterns: three panels per level, every kind named once, every record a dot in each panel") {
  const Figure figure = patterns_figure(model_with(synthetic_patterns()).view());
  CHECK(figure.name == "patterns");
  REQUIRE(figure.panels.size() == 1 + 2 * 3);
  for (const char* label : {"600\">field error, constraint level 1<", "600\">worst node, constraint level 2<"}) {
    CHECK(count(figure.svg(), label) == 1);
  }
  CHECK(figure.svg().find("constraint level 2") < figure.svg().find("constraint level 1"));
  for (const char* kind : {">node<", ">patch<", ">turned<", ">pinch<"}) CHECK(count(figure.svg(), kind) == 1);
  CHECK(count(figure.svg(), ">sphere<") == 0);
  CHECK(count(figure.svg(), "field error [%]") == 2);
  CHECK(count(figure.svg(), "<circle") == 4 + 6 * synthetic_patterns().size());
}

TEST_CASE("patterns: errors of zero and of compliances that are not definite have a place") {
  auto patterns = synthetic_patterns();
  for (float& error : patterns[0].field_error) error = 0;
  for (float& error : patterns[4].force_error) error = std::numeric_limits<float>::max();
  const Figure figure = patterns_figure(model_with(patterns).view());
  for (const char* forbidden : {"nan", "inf", "e+"}) CHECK(figure.svg().find(forbidden) == std::string::npos);
}

}  // namespace greenloop::offline
