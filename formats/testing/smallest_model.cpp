#include "formats/testing/smallest_model.hpp"

#include <algorithm>
#include <random>

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

namespace {

constexpr layout::Scale<3> unit_scale{.root = {root_of_compliance, 0, 0, root_of_compliance, 0, root_of_compliance},
                                      .diagonal = {1, 0, 0, 1, 0, 1}};

// `wanted` different numbers below `end`
std::vector<std::uint32_t> different(std::mt19937& random, std::uint32_t end, std::size_t wanted) {
  std::vector<std::uint32_t> found;
  while (found.size() < wanted) {
    const auto one = static_cast<std::uint32_t>(random() % end);
    if (std::find(found.begin(), found.end(), one) == found.end()) found.push_back(one);
  }
  return found;
}

LevelData crowded_level(std::uint32_t nodes, std::uint32_t begin, bool butterfly, std::mt19937& random) {
  LevelData level;
  const layout::NodeRecord node{{0, 0, 0}, 1, layout::node_domain | layout::node_touchable | layout::node_read};
  level.nodes.assign(nodes, node);
  for (std::uint32_t i = 0; i < nodes; ++i) level.scales.push_back(unit_scale);
  for (std::uint32_t i = 0; begin > 0 && i < nodes; ++i) {
    const auto near = different(random, begin, 6);
    level.refinement.push_back({.parent = {near[0], near[1]}, .lift = {0.25F, 0.25F}});
    if (butterfly)
      level.stencils.push_back({.wing = {near[2], near[3]}, .outer = {near[4], near[5], near[0], near[1]}});
  }
  for (CouplingsData& layer : level.couplings) layer.begin.assign(nodes + std::size_t{1}, 0);
  return level;
}

}  // namespace

ModelData crowded_model(std::uint32_t nodes, std::uint32_t levels, layout::Wavelet wavelet) {
  std::mt19937 random(1);
  ModelData model = smallest_model();
  model.info.wavelet = static_cast<std::uint32_t>(wavelet);
  model.info.coarsest_constraint_level = levels - 1;
  model.levels.clear();
  const bool butterfly = wavelet == layout::Wavelet::lifted_butterfly || wavelet == layout::Wavelet::butterfly;
  std::vector<std::vector<std::uint32_t>> representatives(levels);
  for (std::uint32_t q = 0; q < levels; ++q) {
    model.levels.push_back(crowded_level(nodes, q * nodes, butterfly, random));
    for (std::uint32_t i = 0; i < nodes; ++i) representatives[q].push_back(q * nodes + i);
  }
  model.levels.back().representatives = representatives;
  return model;
}

}  // namespace greenloop
