#include "offline/report/body_figures.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "offline/report/axis.hpp"
#include "offline/report/colour_map.hpp"
#include "offline/report/mesh_picture.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr const char* fixed_paint = "#1261ad";
constexpr const char* touchable_paint = "#a9d1ea";
constexpr const char* push_paint = "#1c2329";  // over the picture, whose colours are those of a light page
constexpr const char* hidden_push_paint = "#5a656e";
constexpr const char* rim_paint = "#ffffff";
constexpr const char* rest_paint = "#858c94";

double diagonal(const std::vector<Vector3d>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& position : positions) box.extend(position);
  return box.diagonal().norm();
}

/// A picture placed in a figure, and where its points come to lie.
struct PlacedPicture {
  Rectangle area;
  Camera camera;

  [[nodiscard]] Point at(const Vector3d& position) const {
    const Vector3d pixel = camera.project(position);
    const double shrink = area.width / camera.width;
    return {area.x + shrink * pixel.x(), area.y + shrink * pixel.y()};
  }
};

PlacedPicture place(SvgCanvas& canvas, const Picture& picture, const Rectangle& room) {
  const double shrink = std::min(room.width / picture.image.width, room.height / picture.image.height);
  const double width = shrink * picture.image.width, height = shrink * picture.image.height;
  const Rectangle area{room.x + (room.width - width) / 2, room.y + (room.height - height) / 2, width, height};
  canvas.image(area, png_data_uri(picture.image));
  return {area, picture.camera};
}

void draw_colour_bar(SvgCanvas& canvas, const Rectangle& area, double largest) {
  const SiPrefix prefix = si_prefix(largest);
  canvas.text({area.x, area.y - 12}, fmt::format("[{}m]", prefix.symbol));
  canvas.vertical_gradient(area, "displacement", displacement_gradient(13));
  const Scale scale{.min = 0, .max = largest > 0 ? largest : 1, .from = area.bottom(), .to = area.y};
  for (const double tick : scale.ticks(5)) {
    canvas.line({area.right(), scale(tick)}, {area.right() + 5, scale(tick)}, {paint::rule, 1});
    canvas.text({area.right() + 9, scale(tick) + 4}, readable(tick / prefix.factor), {.paint = paint::muted});
  }
}

/// The node whose displaced position is nearest to `point`.
std::size_t nearest_node(const VisibleSurface& surface, const DrawnDisplacement& drawn, const Vector3d& point) {
  std::size_t nearest = 0;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.positions.size(); ++i) {
    const double distance = (surface.positions[i] + drawn.displacement[i] - point).squaredNorm();
    if (distance < best) best = distance, nearest = i;
  }
  return nearest;
}

/// An arrow that pushes against the body where a probe touches it, from `outward`; dashed and grey if from behind.
void draw_push(SvgCanvas& canvas, Point tip, Point outward, bool behind, const std::string& label) {
  constexpr double length = 58, head = 11, half_width = 5;
  const double norm = std::max(std::hypot(outward.x, outward.y), 1e-12);
  const double ux = outward.x / norm, uy = outward.y / norm;
  const Point tail{tip.x + length * ux, tip.y + length * uy}, neck{tip.x + head * ux, tip.y + head * uy};
  const char* colour = behind ? hidden_push_paint : push_paint;
  canvas.line(tail, neck, {rim_paint, 5});
  canvas.line(tail, neck, {colour, 2.4, behind ? "4 3" : ""});
  const auto tip_of = [&](double grown) {
    const double half = half_width + grown;
    const Point base{neck.x + grown * ux, neck.y + grown * uy};
    return std::vector<Point>{{tip.x - grown * ux, tip.y - grown * uy},
                              {base.x - half * uy, base.y + half * ux},
                              {base.x + half * uy, base.y - half * ux}};
  };
  canvas.polygon(tip_of(2), rim_paint);
  canvas.polygon(tip_of(0), colour);
  const Anchor anchor = ux > 0.3 ? Anchor::start : ux < -0.3 ? Anchor::end : Anchor::middle;
  canvas.text({tail.x + 6 * ux, tail.y + (uy < 0 ? -5 : 14)}, label,
              {.paint = colour, .anchor = anchor, .bold = true, .halo = rim_paint});
}

void draw_pushes(SvgCanvas& canvas, const PlacedPicture& picture, const VisibleSurface& surface,
                 const DrawnDisplacement& drawn, const TraceCycle& cycle) {
  constexpr double behind = -0.3;  // cosine between the outward direction and the view
  const ViewFrame& frame = picture.camera.frame;
  for (const ProbeState& probe : cycle.probes) {
    if (probe.force.norm() < 0.01 * cycle.force || probe.force.isZero()) continue;
    const std::size_t node = nearest_node(surface, drawn, probe.centre);
    const Vector3d out = probe.force.normalized();  // the body pushes the probe outwards
    draw_push(canvas, picture.at(surface.positions[node] + drawn.magnified[node]),
              {out.dot(frame.right), -out.dot(frame.up)}, out.dot(frame.towards) < behind,
              readable(probe.force.norm(), 3) + "\u202fN");
  }
}

void draw_key(SvgCanvas& canvas, Point at, const std::string& paint, bool dot, const std::string& text) {
  if (dot) {
    canvas.circle({at.x + 9, at.y - 4}, 4, paint);
  } else {
    canvas.line({at.x, at.y - 4}, {at.x + 18, at.y - 4}, {paint, 2});
  }
  canvas.text({at.x + 26, at.y}, text, {.paint = paint::muted});
}

std::string factor_text(double factor) {
  if (factor == 1) return "drawn at true scale";
  return factor > 1 ? fmt::format("drawn {}×", readable(factor)) : fmt::format("drawn at 1/{}", readable(1 / factor));
}

}  // namespace

DrawnDisplacement drawn_displacement(const std::vector<Vector3d>& positions, std::vector<Vector3d> displacement) {
  DrawnDisplacement drawn{.displacement = std::move(displacement), .magnified = {}};
  for (std::size_t i = 0; i < drawn.displacement.size(); ++i) {
    const double size = drawn.displacement[i].norm();
    if (size > drawn.largest) drawn.largest = size, drawn.largest_node = i;
  }
  drawn.factor = exaggeration(drawn.largest, diagonal(positions));
  for (const Vector3d& one : drawn.displacement) drawn.magnified.push_back(drawn.factor * one);
  return drawn;
}

Figure body_figure(const VisibleSurface& surface, const DrawnDisplacement& drawn, const ViewFrame& frame,
                   const TraceCycle* cycle) {
  std::vector<float> value;
  for (const Vector3d& one : drawn.displacement) {
    value.push_back(drawn.largest > 0 ? static_cast<float>(one.norm() / drawn.largest) : 0.0F);
  }
  const SiPrefix prefix = si_prefix(drawn.largest);
  std::string caption = fmt::format(
      "The body {}, displacements {}. Largest displacement: {}\u202f{}m at node {}.",
      cycle != nullptr ? fmt::format("at {}\u202fs, when the force is largest ({}\u202fN on {} contact nodes)",
                                     readable(cycle->time), readable(cycle->force, 3), cycle->contacts)
                       : "as in the snapshot",
      factor_text(drawn.factor), readable(drawn.largest / prefix.factor, 3), prefix.symbol, drawn.largest_node);
  if (drawn.largest > 0.1 * diagonal(surface.positions)) {
    caption += " That is more than a tenth of the body's size: too far for linear elasticity.";
  }
  constexpr double height = 430, side = 76, key = 1.6 * panel_text;
  SvgCanvas canvas(panel_width, height + 3 * key, "The deformed body", caption, panel_text);
  const PlacedPicture picture = place(canvas, deformed_picture(surface, drawn.magnified, value, frame, 1000),
                                      {20, 30, panel_width - side - 30, height - 50});
  if (cycle != nullptr) draw_pushes(canvas, picture, surface, drawn, *cycle);
  draw_colour_bar(canvas, {panel_width - side + 14, 70, 16, 250}, drawn.largest);
  draw_key(canvas, {8, height + key}, rest_paint, false, "outline at rest");
  draw_key(canvas, {8, height + 2 * key}, fixed_paint, true, "held in place");
  canvas.text({panel_width / 2, height + key}, factor_text(drawn.factor), {.bold = true});
  if (cycle != nullptr)
    draw_key(canvas, {panel_width / 2, height + 2 * key}, paint::ink, false, "force; dashed: behind");
  return {"body", "The deformed body", caption, {canvas}};
}

Figure mesh_figure(const ModelSurface& surface, const ViewFrame& frame) {
  const int finest = surface.mesh.finest_level();
  const std::string caption = fmt::format(
      "The base mesh and its subdivision {} times over: the levels of the wavelet transform. {} of {} nodes may be "
      "touched, "
      "{} are held in place.",
      finest, readable_count(surface.count(layout::node_touchable)), readable_count(surface.flags.size()),
      readable_count(surface.count(layout::node_fixed)));
  constexpr double height = 330, width = panel_width / 2, key = 1.6 * panel_text;
  SvgCanvas canvas(panel_width, height + 3 * key, "Base and finest mesh", caption, panel_text);
  double x = 0;
  for (const int level : finest == 0 ? std::vector{0} : std::vector{0, finest}) {
    const VisibleSurface visible = surface.level(level);
    (void)place(canvas, wire_picture(visible, surface.touchable(level), surface.mesh.positions, frame, 800),
                {x + 6, 10, width - 12, height - 20});
    canvas.text({x + width / 2, height + key},
                fmt::format("level {}: {} nodes", level, readable_count(visible.positions.size())),
                {.anchor = Anchor::middle});
    x += width;
  }
  draw_key(canvas, {8, height + 2 * key}, touchable_paint, true, "may be touched");
  draw_key(canvas, {panel_width / 2, height + 2 * key}, fixed_paint, true, "held in place");
  return {"meshes", "Base and finest mesh", caption, {canvas}};
}

}  // namespace greenloop::offline
