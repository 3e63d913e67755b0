#include "formats/testing/smallest_model.hpp"

namespace greenloop {

namespace {

constexpr float root_of_compliance = 0.25F;  // (m/N)^(1/2)

// but for what has components
ModelData two_free_nodes(layout::Problem problem) {
  constexpr float third_of_triangle = 0.5F / 3;  // m^2
  constexpr float quantum = 1.0F / 1024;
  ModelData model;
  model.info.problem = static_cast<std::uint32_t>(problem);
  model.info.wavelet = static_cast<std::uint32_t>(layout::Wavelet::lifted_linear);
  model.info.components = layout::components_of(problem);
  model.info.rate = 1000;
  model.info.max_contacts = 1;
  model.info.step_work = 1000;
  model.info.quantum[0] = quantum;
  model.provenance = "{}";
  model.base_triangles = {0, 1, 2};

  LevelData level;
  level.nodes = {{{0, 0, 0}, third_of_triangle, layout::node_domain | layout::node_touchable | layout::node_read},
                 {{1, 0, 0}, third_of_triangle, layout::node_domain | layout::node_read},
                 {{0, 1, 0}, third_of_triangle, layout::node_fixed}};
  level.representatives = {{0, layout::none, layout::none}};
  for (CouplingsData& layer : level.couplings) layer.begin = {0, 0, 0};
  model.levels = {level};
  return model;
}

}  // namespace

ModelData smallest_model() {
  ModelData model = two_free_nodes(layout::Problem::elastostatic);
  model.info.young = 1e5;
  model.info.poisson = 0.25;
  const layout::Scale<3> scale = {.root = {root_of_compliance, 0, 0, root_of_compliance, 0, root_of_compliance},
                                  .diagonal = {1, 0, 0, 1, 0, 1}};
  LevelData& level = model.levels.front();
  for (int node = 0; node < 2; ++node) level.scales.push_back(scale);
  level.couplings[0] = {.begin = {0, 0, 1}, .index = {0}, .value = {256, 0, 0, 0, 256, 0, 0, 64, 256}};
  return model;
}

ModelData smallest_scalar_model() {
  ModelData model = two_free_nodes(layout::Problem::scalar);
  LevelData& level = model.levels.front();
  for (int node = 0; node < 2; ++node) level.scales.push_back<1>({.root = {root_of_compliance}, .diagonal = {1}});
  level.couplings[0] = {.begin = {0, 0, 1}, .index = {0}, .value = {256}};
  return model;
}

}  // namespace greenloop
