#include "offline/report/pattern_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

// of the kinds in the model, in their order
std::vector<KindStyle> kinds_of(const ModelView& model) {
  std::vector<KindStyle> present;
  for (const KindStyle& style : kind_styles) {
    const bool measured = std::any_of(model.level, model.level + model.levels, [&](const LevelView& level) {
      return std::any_of(level.patterns.begin(), level.patterns.end(),
                         [&](const auto& record) { return record.kind == static_cast<std::uint32_t>(style.kind); });
    });
    if (measured) present.push_back(style);
  }
  return present;
}

SvgCanvas legend_panel(const std::vector<KindStyle>& kinds, const std::string& title, const std::string& caption) {
  constexpr double em = panel_text, pitch = 1.7 * em, column = panel_width / 3;
  const double rows = std::ceil(static_cast<double>(kinds.size()) / 3);
  SvgCanvas canvas(panel_width, rows * pitch + em, title, caption, em);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const std::size_t row = i / 3;
    const double x = 8 + column * static_cast<double>(i % 3), y = pitch * static_cast<double>(1 + row);
    canvas.line({x, y - em / 3}, {x + 22, y - em / 3}, {kinds[i].colour, 2, kinds[i].dashes});
    canvas.circle({x + 11, y - em / 3}, 3, kinds[i].colour);
    canvas.text({x + 28, y}, pattern_name(static_cast<std::uint32_t>(kinds[i].kind)));
  }
  return canvas;
}

SvgCanvas panel(const std::string& heading, const std::string& caption, Records records, const ErrorKind& what) {
  std::vector<double> errors;
  double most_contacts = 1;
  for (const auto& record : records) {
    errors.push_back(drawn((record.*what.error)[2]));
    most_contacts = std::max(most_contacts, double{1} * record.contacts);
  }
  const PanelFrame frame = panel_frame(true, {});
  SvgCanvas canvas(panel_width, frame.height, heading, caption, panel_text);
  canvas.text({frame.area.x, 1.2 * panel_text}, heading, {.bold = true});
  const PlotAxis across{.label = "contacts", .min = 0.75, .max = 1.35 * most_contacts, .logarithmic = true};
  SvgPlot plot(canvas, frame.area, across, logarithmic_axis(what.name, "%", errors));
  for (const KindStyle& style : kind_styles) {
    std::vector<Point> data;
    for (const auto& record : records) {
      if (record.kind != static_cast<std::uint32_t>(style.kind)) continue;
      data.push_back({double{1} * record.contacts, drawn((record.*what.error)[2])});
    }
    plot.curve(data, {style.colour, 1.8, style.dashes});
    plot.dots(data, 3, style.colour);
  }
  return canvas;
}

}  // namespace

bool has_patterns(const ModelView& model) {
  return std::any_of(model.level, model.level + model.levels,
                     [](const LevelView& level) { return !level.patterns.empty(); });
}

Figure patterns_figure(const ModelView& model) {
  const std::string title = "What people do";
  const std::string caption =
      "The worst errors of the model's answers to contacts spread all over the surface, against the exact answers of "
      "the "
      "finest level to the same contacts: of the field in its own norm, of the worst node over the largest "
      "displacement, of the nodal forces. Beyond 0.001 and 1000 % points stand at the edge.";
  Figure figure{"patterns", title, caption, {legend_panel(kinds_of(model), title, caption)}};
  for (std::uint32_t level = model.levels; level-- > 0;) {
    const Records records = model.level[level].patterns;
    if (records.empty()) continue;
    for (const ErrorKind& what : error_kinds) {
      figure.panels.push_back(panel(fmt::format("{}, constraint level {}", what.name, level), caption, records, what));
    }
  }
  return figure;
}

}  // namespace greenloop::offline
