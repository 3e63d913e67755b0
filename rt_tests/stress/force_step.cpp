#include "rt_tests/stress/force_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace greenloop {

double ForceStep::follow(std::span<const Constraint> contacts, bool answered, std::span<const float> force) {
  const bool same = answered && answered_ && contacts.size() == contacts_.size() &&
                    std::memcmp(contacts.data(), contacts_.data(), contacts.size_bytes()) == 0;
  double change = 0, now = 0, before = 0;
  for (std::size_t i = 0; same && i < force.size(); ++i) {
    const double f = double{force[i]}, g = double{force_[i]};
    change += (f - g) * (f - g);
    now += f * f;
    before += g * g;
  }
  answered_ = answered;
  contacts_.assign(contacts.begin(), contacts.end());
  force_.assign(force.begin(), force.end());
  return change > 0 ? std::sqrt(change / std::max(now, before)) : 0;
}

}  // namespace greenloop
