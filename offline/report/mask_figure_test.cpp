#include "offline/report/mask_figure.hpp"

#include <doctest/doctest.h>

#include <string>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/writer.hpp"
#include "offline/report/model_surface.hpp"

namespace greenloop::offline {

TEST_CASE("masks: every touchable node has a stiffness, and more under a mask that spreads the force") {
  const ModelFile model = encoded_file(synthetic_model({.levels = 3, .touchable_above = 0.0}));
  const std::vector<double> single = masked_stiffness(model, 1e-9);
  const std::vector<double> masked = masked_stiffness(model, 0.05);
  const ModelSurface surface = model_surface(model.view);
  REQUIRE(single.size() == model.view.node_count);
  std::size_t touchable = 0, stiffer = 0;
  for (std::size_t node = 0; node < single.size(); ++node) {
    const bool may = (surface.flags[node] & layout::node_touchable) != 0;
    CHECK((single[node] > 0) == may);
    CHECK((masked[node] > 0) == may);
    touchable += may ? 1 : 0;
    stiffer += masked[node] > single[node] ? 1 : 0;
  }
  CHECK(stiffer > touchable / 2);
  const Figure figure = masked_stiffness_figure(model, surface.level(2), 0.05);
  REQUIRE(figure.panels.size() == 2);
  CHECK(figure.panels[1].str().find("N/m") != std::string::npos);
}

}  // namespace greenloop::offline
