#include "rt_tests/stress/starved_steps.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "rt_tests/harness/elastostatic_driver.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/touchable_nodes.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t cycles_of_press = 32, cycles_of_node = 16;
constexpr float depth = 1e-3F;  // m
constexpr std::uint32_t most_contacts = 16;

double square_distance(const float* a, const float* b) {
  double sum = 0;
  for (int r = 0; r < 3; ++r) sum += double{a[r] - b[r]} * double{a[r] - b[r]};
  return sum;
}

// nodes in the order that a tool meets them which starts at one and always takes the nearest that it has not met
std::vector<std::uint32_t> path_over(const ModelView& view, std::uint64_t seed) {
  std::vector<std::uint32_t> left = touchable_nodes(view), path;
  std::mt19937_64 random(seed);
  std::swap(left[random() % left.size()], left.back());
  while (!left.empty()) {
    path.push_back(left.back());
    left.pop_back();
    const float* here = node_record(view, path.back()).position;
    const auto nearest = std::min_element(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
      return square_distance(node_record(view, a).position, here) <
             square_distance(node_record(view, b).position, here);
    });
    if (nearest != left.end()) std::iter_swap(nearest, left.end() - 1);
  }
  return path;
}

// a tool's way over the nodes; apart: a new contact is held in the cycle after an old one has gone, not in the same
struct Tool {
  std::vector<std::uint32_t> path;
  std::size_t contacts = 0;
  bool apart = false;
};

// the tool's constraints in a cycle
std::vector<Constraint> held_in(const Tool& tool, std::uint64_t cycle) {
  const auto& path = tool.path;
  const float share = std::min(1.0F, static_cast<float>(cycle + 1) / static_cast<float>(cycles_of_press));
  const bool comes = cycle >= cycles_of_node && cycle % cycles_of_node == 0;
  const std::size_t contacts = tool.apart && comes ? tool.contacts - 1 : tool.contacts;
  std::vector<Constraint> held;
  for (std::size_t i = 0; i < std::min(contacts, path.size()); ++i) {
    held.push_back({path[(cycle / cycles_of_node + i) % path.size()], {0, 0, -depth * share}});
  }
  return held;
}

struct Motion {
  double largest_step = 0;  // N
  std::uint64_t most_needed = 0;
};

template <Driver D>
Motion move_tool(Hosted<typename D::Solver>& host, const Tool& tool, std::uint64_t cycles, std::uint64_t budget) {
  host.renew();
  Motion motion;
  double last[3] = {};
  for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
    const auto report = host.step(held_in(tool, cycle), budget, false);
    motion.most_needed = std::max(motion.most_needed, report.details.needed_work);
    double total[3] = {}, change = 0;
    for (std::size_t i = 0; i < host.force().size(); ++i) total[i % 3] += double{host.force()[i]};
    for (int r = 0; r < 3; ++r) {
      change += (total[r] - last[r]) * (total[r] - last[r]);
      last[r] = total[r];
    }
    if (cycle > 0) motion.largest_step = std::max(motion.largest_step, std::sqrt(change));
  }
  return motion;
}

}  // namespace

template <Driver D>
StarvedSteps starved_steps(const Model& model, const StressOptions& options, std::uint64_t cycles, double share) {
  const std::uint32_t held = std::min(options.contacts, most_contacts);
  Hosted<typename D::Solver> host(model, D::limits(held, options.factors, options.prices));
  const Tool tool{path_over(model.view(), options.seed), held, false};
  const Tool apart{tool.path, held, true};
  const Motion finest = move_tool<D>(host, tool, cycles, any_budget);
  const std::uint64_t least = D::bounds(host.limits(), host.requirement()).least_work;
  const auto over_finest = [&](const Tool& moved, std::uint64_t budget) {
    const double step = move_tool<D>(host, moved, cycles, std::max(least, budget)).largest_step;
    return finest.largest_step > 0 ? step / finest.largest_step : 0;
  };
  return {finest.largest_step,
          over_finest(tool, static_cast<std::uint64_t>(share * static_cast<double>(finest.most_needed))),
          over_finest(tool, finest.most_needed / 4), over_finest(apart, any_budget)};
}

template StarvedSteps starved_steps<ElastostaticDriver>(const Model&, const StressOptions&, std::uint64_t, double);

}  // namespace greenloop
