#include "sim_hw/motion/motion_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace greenloop {
namespace {

/// q_u in m and q_v in m/s of a row.
struct State {
  std::vector<double> displacement, velocity;
};

double square(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t m = 0; m < a.size(); ++m) sum += (a[m] - b[m]) * (a[m] - b[m]);
  return sum;
}

class Rows {
 public:
  explicit Rows(const ImpulseResponseView& view) : view_(view) {}

  [[nodiscard]] std::vector<double> coordinate(std::uint32_t row) const {
    std::vector<double> q;
    for (std::uint32_t g = 0; g < view_.levels; ++g) {
      const std::size_t modes = view_.group[g].counts->modes;
      for (std::size_t m = 0; m < modes; ++m) {
        q.push_back(view_.group[g].coordinates[modes * row + m] *
                    static_cast<double>(view_.group[g].amplitudes[m].amplitude) / layout::most_coordinate);
      }
    }
    return q;
  }

  // row: behind its orbit's first
  [[nodiscard]] State state(const layout::OrbitRecord& orbit, std::uint32_t row) const {
    State state = {coordinate(row), std::vector<double>(view_.modes)};
    const bool rests = orbit.next_orbit == layout::none && row == orbit.first_row + orbit.rows - 1;
    const std::vector<double> before = coordinate(row - 1);
    for (std::size_t m = 0; m < view_.modes && !rests; ++m) {
      state.velocity[m] = (state.displacement[m] - before[m]) / view_.info->time_step;
    }
    return state;
  }

 private:
  const ImpulseResponseView& view_;
};

}  // namespace

MotionBounds motion_bounds(const Model& model, const ImpulseResponse::Limits& limits) {
  const ImpulseResponseView& view = model.view().impulse_response;
  const double period = 1 / static_cast<double>(limits.rate > 0 ? limits.rate : view.info->rate);
  const double lambda = static_cast<double>(limits.blend_rate > 0 ? limits.blend_rate : view.info->blend_rate);
  const double rows = period * static_cast<double>(limits.stretch) / view.info->time_step;
  const double balance = static_cast<double>(view.info->velocity_balance);
  const Rows all(view);
  const std::vector<double> rest(view.modes);
  MotionBounds bounds;
  const auto add = [&](double u, double v, double MotionBound::*what) {
    const auto keep = [&](MotionBound& bound, double value) { bound.*what = std::max(bound.*what, value); };
    keep(bounds.displacement, std::sqrt(u));
    keep(bounds.velocity, std::sqrt(v));
    keep(bounds.state, std::sqrt(u + balance * balance * v));
  };
  for (const layout::OrbitRecord& orbit : view.orbits) {
    State last;
    for (std::uint32_t row = orbit.first_row + 1; row < orbit.first_row + orbit.rows; ++row) {
      State now = all.state(orbit, row);
      add(square(now.displacement, rest), square(now.velocity, rest), &MotionBound::most);
      if (!last.displacement.empty()) {
        add(rows * rows * square(now.displacement, last.displacement),
            rows * rows * square(now.velocity, last.velocity), &MotionBound::moves);
      }
      last = std::move(now);
    }
  }
  for (MotionBound* bound : {&bounds.displacement, &bounds.velocity, &bounds.state}) {
    bound->left = std::exp(-lambda * period);
  }
  return bounds;
}

}  // namespace greenloop
