#include "offline/report/mask_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "offline/report/axis.hpp"
#include "offline/report/mesh_picture.hpp"
#include "offline/report/theme.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/mask.hpp"
#include "runtime/stiffness.hpp"
#include "runtime/surface.hpp"

namespace greenloop::offline {
namespace {

constexpr std::uint32_t most_masked = 4096;  // nodes of a mask, beside one contact
constexpr float single = 1e-12F;             // m, a radius that reaches no other node

// the finest surface of a model, with its memory
struct FinestSurface {
  explicit FinestSurface(const Model& model)
      : level(model.view().levels - 1), memory(Surface::required(model, level).bytes) {
    const auto created = Surface::create(model, level, {memory.data(), memory.size()});
    if (!created) throw std::runtime_error("the model has no surface");
    surface = created.surface;
  }
  std::uint32_t level;
  AlignedBytes memory;
  Surface surface;
};

float stiffness_of(Elastostatic& body, std::uint32_t node, const Mask& mask) {
  float block[9];
  if (body.masked_compliance(node, mask, block) == 0 || !invert_compliance(block, block)) {
    throw std::runtime_error(fmt::format("node {} has no stiffness", node));
  }
  return stiffness_norm(block);
}

}  // namespace

SvgCanvas value_panel(const VisibleSurface& surface, const ViewFrame& frame, const std::string& name,
                      const std::string& unit, const std::vector<double>& value) {
  const double most = *std::max_element(value.begin(), value.end());
  double least = most;
  std::vector<float> share;
  for (const double one : value) {
    if (one > 0) least = std::min(least, one);
    share.push_back(most > 0 ? static_cast<float>(one / most) : 0.0F);
  }
  const SiPrefix prefix = si_prefix(most);
  const std::string range = fmt::format("{} to {}\u202f{}{}", readable(least / prefix.factor, 3),
                                        readable(most / prefix.factor, 3), prefix.symbol, unit);
  constexpr double height = 300, key = 1.6 * panel_text;
  SvgCanvas canvas(panel_width, height + 2 * key, name, name + ": " + range, panel_text);
  const std::vector<Eigen::Vector3d> still(surface.positions.size(), Eigen::Vector3d::Zero());
  const Picture drawn = deformed_picture(surface, still, share, frame, 600);
  const double shrink = std::min((panel_width - 20) / drawn.image.width, (height - 20) / drawn.image.height);
  const double wide = shrink * drawn.image.width, high = shrink * drawn.image.height;
  canvas.image({(panel_width - wide) / 2, (height - high) / 2, wide, high}, png_data_uri(drawn.image));
  canvas.text({panel_width / 2, height + 0.6 * key}, name, {.anchor = Anchor::middle, .bold = true});
  canvas.text({panel_width / 2, height + 1.6 * key}, range, {.paint = paint::muted, .anchor = Anchor::middle});
  return canvas;
}

std::vector<double> masked_stiffness(const ModelFile& model, double radius) {
  const auto opened = Model::open({model.bytes.data(), model.bytes.size()});
  const Elastostatic::Limits limits{
      .max_contacts = 1, .cached_factors = 1, .forces_only = true, .max_forces = most_masked, .max_points = 1};
  AlignedBytes memory(Elastostatic::required(opened.model, limits).bytes);
  auto created = Elastostatic::create(opened.model, limits, {memory.data(), memory.size()});
  if (!created) throw std::runtime_error("the runtime takes no masks on this model");
  const FinestSurface finest(opened.model);
  std::vector<std::uint32_t> node(most_masked + 1);
  std::vector<float> weight(most_masked + 1);
  std::vector<double> norm(opened.model.node_count(), 0.0);
  for (std::uint32_t i = 0; i < norm.size(); ++i) {
    if (!opened.model.is_touchable(i)) continue;
    const Mask mask = make_mask(finest.surface, finest.level, at_node(i), static_cast<float>(radius), node, weight);
    if (mask.node.empty()) {
      throw std::runtime_error(fmt::format("a mask of {} m has more than {} nodes", radius, node.size()));
    }
    norm[i] = double{stiffness_of(created.body, i, mask)};
  }
  return norm;
}

Figure masked_stiffness_figure(const ModelFile& model, const VisibleSurface& surface, double radius) {
  const ViewFrame frame = choose_view(surface, {});
  Figure figure{
      "masks",
      "Stiffness of point-like contact",
      fmt::format("How stiff every touchable node is, by itself and under a mask of {}\u202fm: of a force that "
                  "is spread over the nodes within that radius. By itself a node is as soft as the mesh is "
                  "fine there.",
                  readable(radius, 3)),
      {}};
  figure.panels.push_back(value_panel(surface, frame, "Single nodes", "N/m", masked_stiffness(model, double{single})));
  figure.panels.push_back(value_panel(surface, frame, "Masked", "N/m", masked_stiffness(model, radius)));
  return figure;
}

}  // namespace greenloop::offline
