#include "offline/report/theme.hpp"

#include <fmt/format.h>

namespace greenloop::offline {
namespace {

void replace_all(std::string& text, const std::string& from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

std::string with_light_colours(std::string drawing) {
  for (const ThemeColour& colour : theme_colours) {
    replace_all(drawing, fmt::format("var(--{})", colour.name), colour.light);
  }
  return drawing;
}

std::string theme_css() {
  std::string light, dark;
  for (const ThemeColour& colour : theme_colours) {
    light += fmt::format("--{}:{};", colour.name, colour.light);
    dark += fmt::format("--{}:{};", colour.name, colour.dark);
  }
  return fmt::format(
      ":root{{color-scheme:light dark;{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{}}}}}\n", light,
      dark);
}

}  // namespace greenloop::offline
