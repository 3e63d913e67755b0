#include "offline/pipeline/motion_appearance.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "offline/appearance/appearance_model.hpp"

namespace greenloop::offline {
namespace {

using nlohmann::json;

std::vector<Eigen::Array3f> reflectances(const AppearanceScene& scene, const ImpulseResponseData& model) {
  std::vector<Eigen::Vector3d> positions;
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v + 2 < model.shape.size(); v += 3) {
    positions.emplace_back(model.shape[v], model.shape[v + 1], model.shape[v + 2]);
    box.extend(positions.back());
  }
  std::vector<Eigen::Array3f> result(positions.size(), scene.reflectance.cast<float>().array());
  for (const PaintedPart& part : scene.parts) {
    const std::vector<bool> painted = evaluate(part.box, positions, box);
    for (std::size_t v = 0; v < painted.size(); ++v) {
      if (painted[v]) result[v] = part.reflectance.cast<float>().array();
    }
  }
  return result;
}

json record_of(const Appearance& appearance) {
  json sampling = json::array();
  for (const SampledError& error : appearance.sampling) {
    sampling.push_back({{"states", error.states},
                        {"rank", error.rank},
                        {"error", error.error},
                        {"truncation", error.truncation},
                        {"error_of_transfer", error.of_transfer}});
  }
  return {{"sampling", sampling}, {"singular_values", appearance.singular_values}, {"noise", appearance.noise}};
}

}  // namespace

json add_appearance(const AppearanceScene& scene, ImpulseResponseData& model, ProgressBar& progress) {
  AppearanceGoal goal;
  goal.transfer.rays = scene.rays;
  goal.transfer.bounces = scene.bounces;
  goal.error = scene.error;
  goal.rank = scene.rank;
  goal.states = scene.states;
  progress.begin("light");
  Appearance appearance = appearance_of(model, reflectances(scene, model), goal, [&](auto done, auto states) {
    progress.update(static_cast<double>(done) / states);
  });
  const SampledError& reached = appearance.sampling.back();
  progress.end(fmt::format("{} modes of {} states, error of others {:.3g} % of the variation, {:.3g} % of the transfer",
                           reached.rank, reached.states, 100 * reached.error, 100 * reached.of_transfer));
  if (reached.error > scene.error) {
    progress.warn(
        fmt::format("the appearance of states that light was not computed for is {:.3g} % off, appearance.error "
                    "asks for {:.3g} %; raise appearance.states or appearance.rank",
                    100 * reached.error, 100 * scene.error));
  }
  json record = record_of(appearance);
  model.appearance = std::move(appearance.data);
  return record;
}

}  // namespace greenloop::offline
