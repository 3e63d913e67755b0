#pragma once

#include <string>
#include <vector>

#include "offline/report/axis.hpp"
#include "offline/report/svg_canvas.hpp"

namespace greenloop::offline {

struct PlotAxis {
  std::string label;  ///< quantity and unit, "force [mN]"
  double min = 0;
  double max = 1;
  bool logarithmic = false;
  double unit = 1;     ///< data value of one unit of the label
  bool whole = false;  ///< ticks at whole numbers only
};

/// From zero to a little above `largest` with an SI prefix before `unit`: "force [mN]"; before a unit that is a word a
/// power of ten: "work [10⁶ units]".
[[nodiscard]] PlotAxis axis_from_zero(const std::string& quantity, const std::string& unit, double largest);

/// Spans `values` (at least one, all > 0) on a logarithmic axis with air at both ends and an SI prefix before `unit`;
/// a `unit` of "%" takes none and shows 0.01 as 1.
[[nodiscard]] PlotAxis logarithmic_axis(const std::string& quantity, const std::string& unit,
                                        const std::vector<double>& values);

struct LegendEntry {
  std::string text;
  Stroke stroke;
  bool marker = false;  ///< a dot rather than a line
};

/// Axes with a grid within a part of a canvas, and data on them. The frame, ticks and labels are drawn at construction,
/// left of and below `area`; the legend stands in rows above it, clear of the data. Texts have the canvas's size.
class SvgPlot {
 public:
  SvgPlot(SvgCanvas& canvas, const Rectangle& area, const PlotAxis& x, const PlotAxis& y);

  [[nodiscard]] Point at(double x, double y) const { return {x_(x), y_(y)}; }

  /// A line through data points (x, y), downsampled to the pixels it covers.
  void curve(const std::vector<Point>& data, const Stroke& stroke);
  /// A line that holds each y until the next x, downsampled likewise.
  void steps(const std::vector<Point>& data, const Stroke& stroke);
  /// The area between the curve and the axis, downsampled likewise.
  void area_below(const std::vector<Point>& data, const std::string& fill, double opacity);
  void dots(const std::vector<Point>& data, double radius, const std::string& fill, const Stroke& stroke = {"none"});
  /// Crosses, e.g. for failures; at most one per pixel column.
  void crosses(const std::vector<Point>& data, const std::string& paint);
  void legend(const std::vector<LegendEntry>& entries);

 private:
  void draw_frame(const PlotAxis& x, const PlotAxis& y);
  [[nodiscard]] std::vector<Point> placed(const std::vector<Point>& data) const;

  SvgCanvas& canvas_;
  Rectangle area_;
  Scale x_;
  Scale y_;
};

/// A panel of the report with one plot.
struct PanelFrame {
  double height = 0;  ///< of the canvas, which is panel_width wide
  Rectangle area;     ///< of the plot
};

/// Leaves room for a line of heading above the plot if there is one, for the legend in as many rows as it takes, and
/// for ticks and labels.
[[nodiscard]] PanelFrame panel_frame(bool heading, const std::vector<LegendEntry>& legend, double plot_height = 200);

/// One bar of a bar chart.
struct Bar {
  std::string label;
  double value = 0;
  std::string value_text;
  std::string fill;
};

/// Horizontal bars, one per row of `area`, under their labels and values.
void horizontal_bars(SvgCanvas& canvas, const Rectangle& area, const std::vector<Bar>& bars);

}  // namespace greenloop::offline
