#include "offline/report/svg_canvas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/output/printable.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

std::string pixels(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string stroke_attributes(const Stroke& stroke) {
  if (stroke.paint == "none") return {};
  std::string text = fmt::format(R"( stroke="{}" stroke-width="{}")", stroke.paint, stroke.width);
  if (!stroke.dashes.empty()) text += fmt::format(R"( stroke-dasharray="{}")", stroke.dashes);
  if (stroke.opacity != 1) text += fmt::format(R"( stroke-opacity="{}")", stroke.opacity);
  return text;
}

/// Path data in relative moves: a long trace takes half the characters.
std::string path_data(const std::vector<Point>& points) {
  std::string data;
  long x = 0, y = 0;
  for (const Point& point : points) {
    const long next_x = std::lround(point.x * 10), next_y = std::lround(point.y * 10);
    data += fmt::format("{}{} {}", data.empty() ? "M" : "l", pixels(static_cast<double>(next_x - x) / 10),
                        pixels(static_cast<double>(next_y - y) / 10));
    x = next_x;
    y = next_y;
  }
  return data;
}

const char* anchor_name(Anchor anchor) {
  switch (anchor) {
    case Anchor::middle:
      return "middle";
    case Anchor::end:
      return "end";
    case Anchor::start:
      break;
  }
  return "start";
}

}  // namespace

std::string escape_markup(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
  }
  return printable(safe);
}

double text_width(std::string_view text, double size) {
  std::size_t characters = 0;
  for (const char c : text) characters += (static_cast<unsigned char>(c) & 0xc0) != 0x80 ? 1 : 0;
  return 0.58 * size * static_cast<double>(characters);
}

SvgCanvas::SvgCanvas(double width, double height, std::string_view title, std::string_view description,
                     double text_size)
    : width_(width), height_(height), text_size_(text_size) {
  head_ = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" role="img" )"
      R"(font-family="system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif">)"
      "<title>{2}</title><desc>{3}</desc>\n",
      pixels(width), pixels(height), escape_markup(title), escape_markup(description));
}

void SvgCanvas::line(Point a, Point b, const Stroke& stroke) {
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>\n", pixels(a.x), pixels(a.y), pixels(b.x),
                       pixels(b.y), stroke_attributes(stroke));
}

void SvgCanvas::polyline(const std::vector<Point>& points, const Stroke& stroke) {
  if (points.size() < 2) return;
  body_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\"{}/>\n", path_data(points),
                       stroke_attributes(stroke));
}

void SvgCanvas::polygon(const std::vector<Point>& points, const std::string& fill, double opacity) {
  if (points.size() < 3) return;
  body_ += fmt::format("<path d=\"{}z\" fill=\"{}\" fill-opacity=\"{}\"/>\n", path_data(points), fill, opacity);
}

void SvgCanvas::rectangle(const Rectangle& area, const std::string& fill, const Stroke& stroke) {
  body_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"{}/>\n", pixels(area.x),
                       pixels(area.y), pixels(area.width), pixels(area.height), fill, stroke_attributes(stroke));
}

void SvgCanvas::circle(Point centre, double radius, const std::string& fill, const Stroke& stroke) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"{}/>\n", pixels(centre.x), pixels(centre.y),
                       radius, fill, stroke_attributes(stroke));
}

void SvgCanvas::text(Point at, std::string_view content, const TextStyle& style) {
  const std::string turn =
      style.turn == 0 ? "" : fmt::format(" transform=\"rotate({} {} {})\"", style.turn, pixels(at.x), pixels(at.y));
  const char* weight = style.bold ? " font-weight=\"600\"" : "";
  const std::string halo =
      style.halo.empty()
          ? ""
          : fmt::format(" stroke=\"{}\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                        style.halo);
  body_ += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\" font-size=\"{}\" text-anchor=\"{}\"{}{}{}>{}</text>\n",
                       pixels(at.x), pixels(at.y), style.paint, style.size > 0 ? style.size : text_size_,
                       anchor_name(style.anchor), weight, halo, turn, escape_markup(content));
}

void SvgCanvas::image(const Rectangle& area, std::string_view data_uri) {
  body_ += fmt::format("<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"{}\"/>\n", pixels(area.x),
                       pixels(area.y), pixels(area.width), pixels(area.height), data_uri);
}

void SvgCanvas::vertical_gradient(const Rectangle& area, const std::string& id,
                                  const std::vector<std::string>& colours) {
  body_ += fmt::format(R"(<linearGradient id="{}" x1="0" y1="1" x2="0" y2="0">)", id);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    body_ += fmt::format(R"(<stop offset="{:.4g}" stop-color="{}"/>)",
                         static_cast<double>(i) / static_cast<double>(colours.size() - 1), colours[i]);
  }
  body_ += "</linearGradient>\n";
  rectangle(area, fmt::format("url(#{})", id), {"var(--rule)", 1});
}

std::string SvgCanvas::str() const { return head_ + body_ + "</svg>\n"; }

std::string standalone_svg(const std::vector<SvgCanvas>& panels, std::size_t columns) {
  std::string content;
  double width = 0, top = 0;
  for (std::size_t begin = 0; begin < panels.size(); begin += columns) {
    double left = 0, height = 0;
    for (std::size_t i = begin; i < std::min(begin + columns, panels.size()); ++i) {
      content +=
          fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n", pixels(left), pixels(top), panels[i].str());
      left += panels[i].width();
      height = std::max(height, panels[i].height());
    }
    width = std::max(width, left);
    top += height;
  }
  return with_light_colours(fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" "
      "width=\"{0}\" height=\"{1}\">\n<rect width=\"100%\" height=\"100%\" fill=\"var(--page)\"/>\n{2}</svg>\n",
      pixels(width), pixels(top), content));
}

}  // namespace greenloop::offline
