#include "offline/report/load_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "formats/write/describe.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/body_figures.hpp"
#include "offline/report/mesh_picture.hpp"
#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t most_pictures = 6;
constexpr double standard_gravity = 9.81;  // m/s^2
constexpr double shown_pressure = 1000;    // Pa

bool is_pressure(const layout::LoadRecord& load) {
  return load.kind == static_cast<std::uint32_t>(layout::LoadKind::pressure);
}

std::string shown_text(const layout::LoadRecord& load) {
  return load_name(load) + (is_pressure(load) ? ", 1\u202fkPa" : ", 9.81\u202fm/s²");
}

SvgCanvas drawn_load(const ModelView& model, const VisibleSurface& surface, std::uint32_t load,
                     const std::string& title) {
  const layout::LoadRecord& record = model.loads[load];
  std::vector<Vector3d> displacement = load_displacement(model, load);
  displacement.resize(surface.positions.size());
  for (Vector3d& one : displacement) one *= is_pressure(record) ? shown_pressure : standard_gravity;
  const DrawnDisplacement drawn = drawn_displacement(surface.positions, std::move(displacement));
  std::vector<float> value;
  for (const Vector3d& one : drawn.displacement) {
    value.push_back(drawn.largest > 0 ? static_cast<float>(one.norm() / drawn.largest) : 0.0F);
  }
  constexpr double height = 300, key = 1.6 * panel_text;
  const SiPrefix prefix = si_prefix(drawn.largest);
  const std::string most = fmt::format("at most {}\u202f{}m, drawn {}×", readable(drawn.largest / prefix.factor, 3),
                                       prefix.symbol, readable(drawn.factor));
  SvgCanvas canvas(panel_width, height + 2 * key, title, shown_text(record) + ": " + most, panel_text);
  const Picture picture = deformed_picture(surface, drawn.magnified, value, choose_view(surface, drawn.magnified), 600);
  const double shrink = std::min((panel_width - 20) / picture.image.width, (height - 20) / picture.image.height);
  const double wide = shrink * picture.image.width, high = shrink * picture.image.height;
  canvas.image({(panel_width - wide) / 2, (height - high) / 2, wide, high}, png_data_uri(picture.image));
  canvas.text({panel_width / 2, height + 0.6 * key}, shown_text(record), {.anchor = Anchor::middle, .bold = true});
  canvas.text({panel_width / 2, height + 1.6 * key}, most, {.paint = paint::muted, .anchor = Anchor::middle});
  return canvas;
}

}  // namespace

std::vector<Vector3d> load_displacement(const ModelView& model, std::uint32_t load) {
  const SurfaceWavelet wavelet(model);
  std::vector<double> x;
  for (std::uint32_t q = 0; q < model.levels; ++q) {
    const float* column = model.level[q].load_column(load);
    x.insert(x.end(), column, column + std::size_t{3} * model.level[q].counts->domain_count);
  }
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) wavelet.merge(level, 3, x.data());
  std::vector<Vector3d> displacement(model.node_count, Vector3d::Zero());
  for (std::size_t row = 0; row < wavelet.rows(); ++row) {
    displacement[wavelet.nodes()[row]] = Eigen::Map<const Vector3d>(x.data() + 3 * row);
  }
  return displacement;
}

Figure loads_figure(const ModelView& model, const VisibleSurface& surface) {
  const std::string title = "Under its loads";
  const auto all = static_cast<std::uint32_t>(model.loads.size()), shown = std::min(all, most_pictures);
  std::string caption =
      "The body under each load that the model holds, while nothing touches it; the outline is the body at rest, "
      "colours go up to the "
      "largest displacement of each picture.";
  if (shown < all) caption += fmt::format(" The first {} of {} loads.", shown, all);
  Figure figure{"loads", title, caption, {}};
  for (std::uint32_t load = 0; load < shown; ++load) {
    figure.panels.push_back(drawn_load(model, surface, load, title));
  }
  return figure;
}

}  // namespace greenloop::offline
