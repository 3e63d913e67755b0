// impulse_cycles MODEL.gloop [--cycles N] [--seed N] [--rate HZ]: random impulses on the motions of a model, illegal
// ones, wrong buffers and starved budgets among them; checks every answer. Prints what was met.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>
#include <vector>

#include "formats/write/model_file.hpp"
#include "rt_tests/harness/impulse_run.hpp"

namespace greenloop {
namespace {

unsigned long long number(std::uint64_t value) { return value; }

int run(const char* file, std::uint64_t cycles, std::uint64_t seed, float rate) {
  const AlignedBytes bytes = load_file(file);
  const auto opened = Model::open(bytes.span());
  if (!opened || opened.model.problem() != layout::Problem::impulse_response) {
    std::fprintf(stderr, "impulse_cycles: %s: this is no impulse response model\n", file);
    return 2;
  }
  const ImpulseResponse::Limits limits{.rate = rate};
  const ImpulseResponseView& view = opened.model.view().impulse_response;
  AlignedBytes memory(ImpulseResponse::required(opened.model, limits).bytes);
  std::vector<float> coordinate(view.modes), velocity(view.modes);
  std::vector<Vec3> displacement(view.info->vertices + 1), displacement_rate(view.info->vertices + 1);
  const ImpulseRun ran =
      run_impulse_script(opened.model, limits, {memory.data(), memory.size()},
                         {coordinate, velocity, displacement, displacement_rate}, cycles, seed, false);
  std::printf(
      "%llu cycles, seed %llu: %llu impulses, %llu continuations; largest blend %.3g m; energy at most %.3g m^2",
      number(ran.cycle), number(seed), number(ran.entered), number(ran.continued), static_cast<double>(ran.most_blend),
      ran.most_energy);
  std::printf("; steps by status:");
  for (const std::uint64_t count : ran.by_status) std::printf(" %llu", number(count));
  std::printf("; digest %016llx\n", number(ran.digest));
  if (ran.error != nullptr) {
    std::printf("cycle %llu: %s\n", number(ran.cycle - 1), ran.error);
    return 1;
  }
  const auto count = [&](Status status) { return ran.by_status[static_cast<std::size_t>(status)]; };
  const bool has_tried = ran.entered > cycles / 200 && count(Status::ok) > 0 && count(Status::coarser) > 0 &&
                         count(Status::held_over_budget) > 0 && count(Status::held_out_of_range) > 0 &&
                         count(Status::held_response_size) > 0;
  if (!has_tried) std::printf("the script did not meet all it is meant to meet\n");
  return has_tried ? 0 : 1;
}

}  // namespace
}  // namespace greenloop

int main(int count, char** argument) {
  std::uint64_t cycles = 20000, seed = 1;
  float rate = 0;
  for (int i = 2; i + 1 < count; i += 2) {
    const std::string_view name(argument[i]);
    if (name == "--rate") {
      rate = std::strtof(argument[i + 1], nullptr);
    } else {
      (name == "--seed" ? seed : cycles) = std::strtoull(argument[i + 1], nullptr, 10);
    }
  }
  if (count < 2) return 2;
  try {
    return greenloop::run(argument[1], cycles, seed, rate);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "impulse_cycles: %s\n", error.what());
    return 2;
  }
}
