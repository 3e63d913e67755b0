#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offline/report/svg_canvas.hpp"

namespace greenloop::offline {

/// One figure of the report: drawings that stand side by side where the page is wide, else one below the other.
struct Figure {
  std::string name;  ///< of its file, without extension
  std::string title;
  std::string caption;  ///< plain text
  std::vector<SvgCanvas> panels;
  std::size_t columns = 2;  ///< of the figure's own file

  /// All panels' elements.
  [[nodiscard]] std::string svg() const {
    std::string elements;
    for (const SvgCanvas& panel : panels) elements += panel.str();
    return elements;
  }
};

/// Width of a figure of one drawing for papers, pixels.
inline constexpr double figure_width = 860;

/// Width of a panel of the report, and size of its text, pixels: as wide as a telephone, on which it stays legible.
inline constexpr double panel_width = 400, panel_text = 15.5;

}  // namespace greenloop::offline
