#include "offline/report/pattern_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "formats/write/describe.hpp"
#include "offline/report/svg_plot.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

using Records = std::span<const layout::PatternRecord>;

constexpr double least_error = 1e-5, most_error = 10;  // drawn at these if beyond

struct KindStyle {
  layout::PatternKind kind;
  const char* colour;
  const char* dashes;
};
constexpr KindStyle kind_styles[] = {
    {layout::PatternKind::node, paint::ink, ""},        {layout::PatternKind::patch, paint::blue, ""},
    {layout::PatternKind::sphere, paint::green, ""},    {layout::PatternKind::turned, paint::sky, ""},
    {layout::PatternKind::gathered, paint::orange, ""}, {layout::PatternKind::pinch, paint::vermilion, ""},
    {layout::PatternKind::opposed, paint::purple, ""},  {layout::PatternKind::alternating, paint::muted, ""},
    {layout::PatternKind::random, paint::muted, "5 3"},
};

struct ErrorKind {
  const char* name;
  const float (layout::PatternRecord::*error)[3];
};
constexpr ErrorKind error_kinds[] = {{"field error", &layout::PatternRecord::field_error},
                                     {"worst node", &layout::PatternRecord::field_peak},
                                     {"nodal forces", &layout::PatternRecord::force_error}};

double drawn(float error) { return std::clamp(double{error}, least_error, most_error); }

void draw_panel(SvgCanvas& canvas, const Rectangle& area, Records records, const ErrorKind& what) {
  std::vector<double> errors;
  double most_contacts = 1;
  for (const auto& record : records) {
    errors.push_back(drawn((record.*what.error)[2]));
    most_contacts = std::max(most_contacts, double{1} * record.contacts);
  }
  const PlotAxis across{.label = "contacts", .min = 0.75, .max = 1.35 * most_contacts, .logarithmic = true};
  SvgPlot plot(canvas, area, across, logarithmic_axis(what.name, "%", errors));
  for (const KindStyle& style : kind_styles) {
    std::vector<Point> data;
    for (const auto& record : records) {
      if (record.kind != static_cast<std::uint32_t>(style.kind)) continue;
      data.push_back({double{1} * record.contacts, drawn((record.*what.error)[2])});
    }
    plot.curve(data, {style.colour, 1.8, style.dashes});
    plot.dots(data, 3, style.colour);
  }
}

// lines and names of all kinds in the model, in rows
void draw_legend(SvgCanvas& canvas, Point at, double width, const ModelView& model) {
  constexpr double size = 11.5, line = 18, gap = 16, pitch = 18;
  double x = at.x;
  for (const KindStyle& style : kind_styles) {
    const auto number = static_cast<std::uint32_t>(style.kind);
    const bool present = std::any_of(model.level, model.level + model.levels, [&](const LevelView& level) {
      return std::any_of(level.patterns.begin(), level.patterns.end(),
                         [&](const auto& record) { return record.kind == number; });
    });
    if (!present) continue;
    const auto name = pattern_name(number);
    const double needed = line + 6 + text_width(name, size);
    if (x > at.x && x + needed > at.x + width) {
      x = at.x;
      at.y += pitch;
    }
    canvas.line({x, at.y - 4}, {x + line, at.y - 4}, {style.colour, 2, style.dashes});
    canvas.circle({x + line / 2, at.y - 4}, 3, style.colour);
    canvas.text({x + line + 6, at.y}, name, {.paint = paint::muted, .size = size});
    x += needed + gap;
  }
}

}  // namespace

bool has_patterns(const ModelView& model) {
  return std::any_of(model.level, model.level + model.levels,
                     [](const LevelView& level) { return !level.patterns.empty(); });
}

Figure patterns_figure(const ModelView& model) {
  constexpr double left = 74, right = 16, legend = 46, top = 26, gap = 84, height = 150, pitch = height + 96;
  constexpr double width = (figure_width - left - right - 2 * gap) / 3;
  const std::string title = "What people do";
  const std::string caption =
      "The worst errors of the model's answers to contacts spread all over the surface, against the exact answers of "
      "the "
      "finest level to the same contacts: of the field in its own norm, of the worst node over the largest "
      "displacement, of the nodal forces. Beyond 0.001 and 1000 % points stand at the edge.";
  const auto measured = std::count_if(model.level, model.level + model.levels,
                                      [](const LevelView& level) { return !level.patterns.empty(); });
  SvgCanvas canvas(figure_width, legend + pitch * static_cast<double>(measured), title, caption);
  draw_legend(canvas, {left, 16}, figure_width - left - right, model);
  double y = legend + top;
  for (std::uint32_t level = model.levels; level-- > 0;) {
    const Records records = model.level[level].patterns;
    if (records.empty()) continue;
    canvas.text({left, y - 10}, fmt::format("constraint level {}", level), {.size = 13, .bold = true});
    double x = left;
    for (const ErrorKind& what : error_kinds) {
      draw_panel(canvas, {x, y, width, height}, records, what);
      x += width + gap;
    }
    y += pitch;
  }
  return {"patterns", title, caption, canvas.str()};
}

}  // namespace greenloop::offline
