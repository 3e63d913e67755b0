#include "offline/wrap/far_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "offline/wrap/level_set.hpp"

namespace greenloop::offline {
namespace {

constexpr float unknown = 1e12F;

/// The lower envelope of parabolas along one line, in place.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : values_(length), parabolas_(length), bounds_(length + 1) {}

  void apply(float* line, std::size_t stride) {
    const int length = static_cast<int>(values_.size());
    for (int i = 0; i < length; ++i) values_[i] = line[static_cast<std::size_t>(i) * stride];
    int last = 0;
    parabolas_[0] = 0;
    bounds_[0] = -std::numeric_limits<double>::infinity();
    for (int i = 1; i < length; ++i) {
      double meets = meeting(parabolas_[last], i);
      while (meets <= bounds_[last]) meets = meeting(parabolas_[--last], i);
      parabolas_[++last] = i;
      bounds_[last] = meets;
    }
    bounds_[last + 1] = std::numeric_limits<double>::infinity();
    for (int i = 0, k = 0; i < length; ++i) {
      while (bounds_[k + 1] < i) ++k;
      const double apart = i - parabolas_[k];
      line[static_cast<std::size_t>(i) * stride] = static_cast<float>(values_[parabolas_[k]] + apart * apart);
    }
  }

 private:
  [[nodiscard]] double meeting(int a, int b) const {
    return (values_[b] - values_[a] + static_cast<double>(b) * b - static_cast<double>(a) * a) / (2.0 * (b - a));
  }

  std::vector<double> values_;
  std::vector<int> parabolas_;
  std::vector<double> bounds_;
};

/// Squared distances continued from where they are known.
void transform_all(std::vector<float>& squared, const Lattice& lattice) {
  for (int axis = 0; axis < 3; ++axis) {
    LineTransform transform(static_cast<std::size_t>(lattice.size[axis]));
    const std::size_t stride = lattice.stride(axis);
    const std::size_t block = stride * static_cast<std::size_t>(lattice.size[axis]);
    for (std::size_t start = 0; start < squared.size(); start += block) {
      for (std::size_t i = 0; i < stride; ++i) transform.apply(squared.data() + start + i, stride);
    }
  }
}

}  // namespace

std::vector<float> far_distance(const std::vector<float>& distance, const Lattice& lattice) {
  std::vector<float> squared(distance.size());
  std::transform(distance.begin(), distance.end(), squared.begin(), [](float d) { return d <= 1 ? d * d : unknown; });
  transform_all(squared, lattice);
  for (std::size_t i = 0; i < squared.size(); ++i) {
    squared[i] = distance[i] < band ? distance[i] : std::max(band, std::sqrt(squared[i]));
  }
  return squared;
}

std::vector<float> distance_to(const std::vector<std::uint8_t>& set, const Lattice& lattice) {
  std::vector<float> squared(set.size());
  std::transform(set.begin(), set.end(), squared.begin(), [](auto belongs) { return belongs != 0 ? 0 : unknown; });
  transform_all(squared, lattice);
  for (float& value : squared) value = std::sqrt(value);
  return squared;
}

}  // namespace greenloop::offline
