#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace greenloop::offline {

/// Text made safe as content and as a quoted attribute of HTML and SVG; control characters become spaces.
[[nodiscard]] std::string escape_markup(std::string_view text);

struct Point {
  double x = 0;
  double y = 0;
};

struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  [[nodiscard]] double right() const { return x + width; }
  [[nodiscard]] double bottom() const { return y + height; }
};

struct Stroke {
  std::string paint;
  double width = 1;
  std::string dashes = {};  ///< as in stroke-dasharray; empty: solid
  double opacity = 1;
};

enum class Anchor { start, middle, end };

struct TextStyle {
  std::string paint = "var(--ink)";
  double size = 0;  ///< pixels; 0: the canvas's
  Anchor anchor = Anchor::start;
  bool bold = false;
  double turn = 0;        ///< degrees clockwise about the anchor
  std::string halo = {};  ///< paint of a rim that keeps the text legible over a picture; empty: none
};

/// Width of a line of text in the report's sans-serif face, pixels; an estimate from above for Latin text.
[[nodiscard]] double text_width(std::string_view text, double size);

/// Writes one SVG drawing; pixels, y downwards. Paints are CSS colours, mostly theme variables (theme.hpp).
class SvgCanvas {
 public:
  /// `title` and `description` are read out by screen readers; `text_size` is that of texts which state none.
  SvgCanvas(double width, double height, std::string_view title, std::string_view description, double text_size = 12);

  void line(Point a, Point b, const Stroke& stroke);
  void polyline(const std::vector<Point>& points, const Stroke& stroke);
  void polygon(const std::vector<Point>& points, const std::string& fill, double opacity = 1);
  void rectangle(const Rectangle& area, const std::string& fill, const Stroke& stroke = {"none"});
  void circle(Point centre, double radius, const std::string& fill, const Stroke& stroke = {"none"});
  void text(Point at, std::string_view content, const TextStyle& style = {});
  /// `data_uri` is a complete URI of the picture.
  void image(const Rectangle& area, std::string_view data_uri);
  /// Bottom-to-top gradient over `colours` ("#rrggbb", evenly spaced, at least two); `id` is unique in the page.
  void vertical_gradient(const Rectangle& area, const std::string& id, const std::vector<std::string>& colours);

  /// The complete element, to stand inside a page.
  [[nodiscard]] std::string str() const;

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] double text_size() const { return text_size_; }

 private:
  double width_;
  double height_;
  double text_size_;
  std::string head_;
  std::string body_;
};

/// Drawings made for a page as a file of their own, `columns` side by side: XML declaration, white ground, light
/// colours.
[[nodiscard]] std::string standalone_svg(const std::vector<SvgCanvas>& panels, std::size_t columns);

}  // namespace greenloop::offline
