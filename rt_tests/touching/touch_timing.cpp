// touch_timing MODEL [STEPS]: what it costs to find out where two tools touch a deformed body. Some nodes far from each
// other are pressed; over the body so deformed two tools slide at random, half a millimetre a step, a spherical tip of
// 5 mm 1 mm deep. Prints medians of thread CPU time, and the work that was counted.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "formats/write/model_file.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/testing/search_bench.hpp"

namespace greenloop {
namespace {

constexpr double tip = 5e-3, depth = 1e-3, step_length = 5e-4;  // m

using Pair = std::array<Double3, 2>;

void press(const TestModel& model, DeformedBody& deformed) {
  TestBody body(model, {.max_contacts = 8});
  const auto nodes = model.touchable();
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < 8; ++i) {
    contacts.push_back({nodes[i * nodes.size() / 8], {-2e-3F, 1e-3F, 1e-3F}});
  }
  if (!answered(body.step(contacts).status)) throw std::runtime_error("the model does not answer these contacts");
  const auto field = as_vec4(std::as_const(body).field());
  std::copy_n(field.begin(), deformed.displacement.size(), deformed.displacement.begin());
  deformed.update();
}

// centres of the tips; at random along the surface, `depth` inside its outside
std::vector<Pair> slides(const DeformedSurface& surface, std::size_t steps) {
  std::mt19937_64 random(5);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Pair at{surface.position(0), surface.position(1)};
  Pair way{Double3{1, 0, 0}, Double3{0, 1, 0}};
  std::vector<Pair> centres;
  for (std::size_t i = 0; i < steps; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      way[k] = unit(way[k] + 0.1 * Double3{between(-1, 1), between(-1, 1), between(-1, 1)});
      std::uint64_t work = 0;
      const SurfacePoint point = surface.closest(at[k] + step_length * way[k], layout::none, work).point;
      at[k] = surface.position(point) + (tip - depth) * surface.normal(point, work);
      way[k] = unit(way[k] - dot(way[k], surface.normal(point, work)) * surface.normal(point, work));
    }
    centres.push_back(at);
  }
  return centres;
}

// medians of processor time, less what reading the clock takes, and the mean of what is counted in a step
template <class Work>
void time_steps(const char* what, std::size_t steps, Work work) {
  const double clock = time_of(1000, [] { (void)thread_microseconds(); });
  std::vector<double> times;
  std::uint64_t units = 0;
  for (std::size_t i = 0; i < steps; ++i) times.push_back(time_of(1, [&] { work(i, units); }) - clock);
  std::printf("%-60s %8.2f us %10.0f units\n", what, bench::median(times),
              static_cast<double>(units) / static_cast<double>(steps));
}

void run(const char* file, std::size_t steps) {
  const TestModel model(load_file(file).span());
  DeformedBody body(model.model());
  press(model, body);
  DeformedSurface& surface = body.surface;
  std::printf("%u nodes, %u triangles\n", surface.node_count(), surface.triangle_count());
  const auto centres = slides(surface, steps);
  time_steps("boxes made anew", steps,
             [&](std::size_t, std::uint64_t& work) { surface.update(body.displacement, work); });
  std::uint32_t last[2] = {layout::none, layout::none};
  double sum = 0;
  const auto closest = [&](std::size_t i, std::uint64_t& work, bool is_guessed) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto found = surface.closest(centres[i][k], is_guessed ? last[k] : layout::none, work);
      last[k] = found.point.triangle;
      sum += found.squared_distance;
    }
  };
  time_steps("closest points of two tools", steps,
             [&](std::size_t i, std::uint64_t& work) { closest(i, work, false); });
  time_steps("the same, near those of the last step", steps,
             [&](std::size_t i, std::uint64_t& work) { closest(i, work, true); });
  time_steps("boxes made anew, and closest points of two tools", steps, [&](std::size_t i, std::uint64_t& work) {
    surface.update(body.displacement, work);
    closest(i, work, true);
  });
  SearchBench bench(body, {.max_tools = 2, .max_candidates = 128});
  const auto search = [&](const char* what, const Shape& shape) {
    std::size_t candidates = 0;
    time_steps(what, steps, [&](std::size_t i, std::uint64_t& work) {
      const Tool tools[2] = {{shape, {centres[i][0], {1, 0, 0, 0}}}, {shape, {centres[i][1], {1, 0, 0, 0}}}};
      candidates += bench.search.find(surface, tools, work).candidates.size();
    });
    std::printf("    candidates in a step: %.1f\n", static_cast<double>(candidates) / static_cast<double>(steps));
  };
  search("candidates of two spheres", Shape::sphere(tip));
  search("candidates of two capsules", Shape::capsule(tip, 0.02));
  search("candidates of two boxes", Shape::box({tip, tip, tip}));
  if (!(sum > 0)) throw std::runtime_error("no distances");
}

}  // namespace
}  // namespace greenloop

int main(int count, char** argument) {
  if (count < 2) return 2;
  try {
    greenloop::run(argument[1], count > 2 ? std::strtoull(argument[2], nullptr, 10) : 5000);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "touch_timing: %s\n", error.what());
    return 1;
  }
  return 0;
}
