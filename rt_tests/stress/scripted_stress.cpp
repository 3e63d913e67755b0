#include "rt_tests/stress/scripted_stress.hpp"

namespace greenloop {

void StepCounts::spend(std::uint64_t work, std::uint64_t most) {
  // as shares, in floating point: products of unlimited budgets would not fit
  if (static_cast<double>(work) * static_cast<double>(declared_work) >=
      static_cast<double>(worst_work) * static_cast<double>(most)) {
    worst_work = work;
    declared_work = most;
  }
}

void StepCounts::add(const StepCounts& other) {
  for (std::size_t i = 0; i < statuses; ++i) by_status[i] += other.by_status[i];
  spend(other.worst_work, other.declared_work);
}

}  // namespace greenloop
