#pragma once

#include <string>
#include <vector>

#include "offline/report/svg_canvas.hpp"

namespace greenloop::offline {

/// One figure of the report.
struct Figure {
  std::string name;  ///< of its file, without extension
  std::string title;
  std::string caption;  ///< plain text
  std::string svg;      ///< SvgCanvas::str
};

/// Width of every figure, pixels.
inline constexpr double figure_width = 860;

}  // namespace greenloop::offline
