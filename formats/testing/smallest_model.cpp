#include "formats/testing/smallest_model.hpp"

namespace greenloop {

ModelData smallest_model() {
  constexpr float third_of_triangle = 0.5F / 3;  // m^2
  constexpr float quantum = 1.0F / 1024;
  constexpr float root_of_compliance = 0.25F;  // (m/N)^(1/2)
  ModelData model;
  model.info.problem = static_cast<std::uint32_t>(layout::Problem::elastostatic);
  model.info.wavelet = static_cast<std::uint32_t>(layout::Wavelet::lifted_linear);
  model.info.components = 3;
  model.info.young = 1e5;
  model.info.poisson = 0.25;
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
  const layout::Scale<3> scale = {.root = {root_of_compliance, 0, 0, root_of_compliance, 0, root_of_compliance},
                                  .diagonal = {1, 0, 0, 1, 0, 1}};
  level.scales.push_back(scale);
  level.scales.push_back(scale);
  for (CouplingsData& layer : level.couplings) layer.begin = {0, 0, 0};
  level.couplings[0] = {.begin = {0, 0, 1}, .index = {0}, .value = {256, 0, 0, 0, 256, 0, 0, 64, 256}};
  model.levels = {level};
  return model;
}

}  // namespace greenloop
