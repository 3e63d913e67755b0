#pragma once

#include <array>
#include <string>
#include <string_view>

namespace greenloop::offline {

/// One colour by its role, for a light and a dark page. The series are the palette of Okabe and Ito, which people with
/// any colour vision tell apart; on the dark page lightened where it would sink in.
struct ThemeColour {
  std::string_view name;
  std::string_view light;
  std::string_view dark;
};

inline constexpr std::array<ThemeColour, 13> theme_colours{{
    {"page", "#ffffff", "#14171a"},
    {"panel", "#f5f6f7", "#1d2125"},
    {"ink", "#1c2329", "#e8eaec"},
    {"muted", "#5a656e", "#a3adb5"},
    {"rule", "#c9cfd4", "#434b52"},
    {"grid", "#e6e9ec", "#2b3136"},
    {"blue", "#0072b2", "#4ba9e0"},
    {"sky", "#56b4e9", "#7cc7f2"},
    {"green", "#009e73", "#2fbf96"},
    {"orange", "#e69f00", "#f0b030"},
    {"vermilion", "#d55e00", "#f0803c"},
    {"purple", "#b65a8e", "#dc93bd"},
    {"yellow", "#c9b700", "#f0e442"},
}};

namespace paint {
inline constexpr const char* none = "none";
inline constexpr const char* page = "var(--page)";
inline constexpr const char* panel = "var(--panel)";
inline constexpr const char* ink = "var(--ink)";
inline constexpr const char* muted = "var(--muted)";
inline constexpr const char* rule = "var(--rule)";
inline constexpr const char* grid = "var(--grid)";
inline constexpr const char* blue = "var(--blue)";
inline constexpr const char* sky = "var(--sky)";
inline constexpr const char* green = "var(--green)";
inline constexpr const char* orange = "var(--orange)";
inline constexpr const char* vermilion = "var(--vermilion)";
inline constexpr const char* purple = "var(--purple)";
}  // namespace paint

/// The same drawing with every theme variable replaced by its light colour, for programs that know no CSS variables.
[[nodiscard]] std::string with_light_colours(std::string drawing);

/// The CSS that gives the variables their values: light, dark on a dark screen, always light on paper.
[[nodiscard]] std::string theme_css();

}  // namespace greenloop::offline
