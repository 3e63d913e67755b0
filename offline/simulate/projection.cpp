#include "offline/simulate/projection.hpp"

#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

namespace greenloop::offline {

Projection::Projection(std::vector<float> rest, int coordinates) : rest_(std::move(rest)), coordinates_(coordinates) {
  if (coordinates < 1 || coordinates > 64) throw std::invalid_argument("projection: 1 to 64 coordinates");
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < rest_.size(); ++i) signs_.push_back(random());
}

Eigen::VectorXf Projection::of(std::span<const float> positions) const {
  if (positions.size() != rest_.size()) throw std::invalid_argument("projection: another count of vertices");
  Eigen::VectorXf sums = Eigen::VectorXf::Zero(coordinates_);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    const float value = positions[i] - rest_[i];
    for (int c = 0; c < coordinates_; ++c) sums[c] += (signs_[i] >> c & 1) != 0 ? value : -value;
  }
  const auto vertices = static_cast<float>(rest_.size()) / 3;
  return sums / std::sqrt(vertices * static_cast<float>(coordinates_));
}

}  // namespace greenloop::offline
