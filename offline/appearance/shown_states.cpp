#include "offline/appearance/shown_states.hpp"

namespace greenloop::offline {

using Eigen::Index;

ShownStates::ShownStates(const ImpulseResponseData& model) : model_(model) {
  std::size_t modes = 0;
  for (const ModeGroupData& group : model.groups) modes += group.amplitudes.size();
  const std::size_t rows = model.groups.front().coordinates.size() / model.groups.front().amplitudes.size();
  coordinates_.resize(static_cast<Index>(modes), static_cast<Index>(rows));
  Index first = 0;
  for (const ModeGroupData& group : model.groups) {
    const std::size_t of_group = group.amplitudes.size();
    for (std::size_t at = 0; at < group.coordinates.size(); ++at) {
      const double unit = static_cast<double>(group.amplitudes[at % of_group].amplitude) / layout::most_coordinate;
      coordinates_(first + static_cast<Index>(at % of_group), static_cast<Index>(at / of_group)) =
          unit * group.coordinates[at];
    }
    first += static_cast<Index>(of_group);
  }
}

std::vector<Eigen::Vector3f> ShownStates::positions(Index row) const {
  std::vector<Eigen::Vector3f> positions;
  for (std::size_t v = 0; v < model_.shape.size() / 3; ++v) {
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (const ModeGroupData& group : model_.groups) {
      const std::size_t modes = group.amplitudes.size();
      for (std::size_t m = 0; m < modes; ++m) {
        const double c = group.coordinates[static_cast<std::size_t>(row) * modes + m];
        for (std::size_t k = 0; k < 3; ++k) moved[static_cast<Index>(k)] += c * group.values[(3 * v + k) * modes + m];
      }
    }
    moved *= static_cast<double>(model_.quanta[v / layout::block_vertices]) / layout::most_coordinate;
    positions.emplace_back(
        (Eigen::Vector3d(model_.shape[3 * v], model_.shape[3 * v + 1], model_.shape[3 * v + 2]) + moved).cast<float>());
  }
  return positions;
}

}  // namespace greenloop::offline
