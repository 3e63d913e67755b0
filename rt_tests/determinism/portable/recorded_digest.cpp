// recorded_digest BUILD [--flip-bit]: runs the recorded script on the models compiled in and compares the digest of all
// answers with the one that every compiler and processor has to find; exits with 4 if they differ. BUILD is what the
// program was meant to be compiled by and for. "--flip-bit" changes one bit of one answer of the last model, which must
// be noticed.
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <span>

#include "recorded_butterfly.h"
#include "recorded_equilibrated.h"
#include "recorded_lifted_butterfly.h"
#include "recorded_model.h"
#include "recorded_motion.h"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/harness/impulse_run.hpp"
#include "rt_tests/harness/recorded_run.hpp"
#include "rt_tests/harness/recorded_script.hpp"
#include "rt_tests/harness/touching_run.hpp"
#include "rt_tests/harness/touching_script.hpp"

namespace {

#if defined(__clang__)
#define GREENLOOP_COMPILER "clang"
#else
#define GREENLOOP_COMPILER "gcc"
#endif
#if defined(__aarch64__)
#define GREENLOOP_PROCESSOR "aarch64"
#elif defined(__AVX512F__)
#define GREENLOOP_PROCESSOR "avx512"
#elif defined(__AVX2__)
#define GREENLOOP_PROCESSOR "avx2"
#elif defined(__x86_64__)
#define GREENLOOP_PROCESSOR "sse2"
#endif
#if defined(__OPTIMIZE__)
#define GREENLOOP_OPTIMISATION "optimised"
#else
#define GREENLOOP_OPTIMISATION "unoptimised"
#endif
constexpr const char* this_build = GREENLOOP_COMPILER "-" GREENLOOP_PROCESSOR "-" GREENLOOP_OPTIMISATION;

bool processor_runs_this() {
#if defined(__AVX512F__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#elif defined(__AVX2__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

alignas(64) std::byte arena[2 << 20];
alignas(16) float field[4 * 512];

struct Recorded {
  const char* wavelets;
  std::span<const std::byte> model;
  std::uint64_t digest;
};
const Recorded recorded[] = {
    {"lifted Linear", std::as_bytes(std::span(recorded_model)), greenloop::recorded_digest},
    {"lifted Butterfly", std::as_bytes(std::span(recorded_lifted_butterfly)),
     greenloop::recorded_lifted_butterfly_digest},
    {"Butterfly", std::as_bytes(std::span(recorded_butterfly)), greenloop::recorded_butterfly_digest},
    {"Equilibrated", std::as_bytes(std::span(recorded_equilibrated)), greenloop::recorded_equilibrated_digest},
};

void print(const Recorded& of, const greenloop::RecordedRun& run) {
  std::printf("%s, %s wavelets: %" PRIu32 " cycles, %" PRIu64 " units of work, %" PRIu64
              " cached factors, arena %zu bytes; answers by status:",
              this_build, of.wavelets, greenloop::RecordedScript::cycles, run.counts.work, run.counts.cached,
              run.arena_bytes);
  for (const std::uint64_t count : run.counts.by_status) {
    std::printf(" %" PRIu64, count);
  }
  std::uint32_t levels = 0;
  for (std::size_t level = 0; level < run.counts.by_level.size(); ++level) {
    levels |= run.counts.by_level[level] > 0 ? 1U << level : 0;
  }
  std::printf("; levels 0x%" PRIx32 "\ndigest %016" PRIx64 ", expected %016" PRIx64 "\n", levels, run.digest,
              of.digest);
}

// 0, or what the program exits with
int compare(const Recorded& of, bool flip) {
  const auto run = greenloop::run_recorded_script<greenloop::ElastostaticDriver>(of.model, arena, field, flip);
  print(of, run);
  if (run.error != nullptr) {
    std::printf("%s\n", run.error);
    return 1;
  }
  return run.digest == of.digest ? 0 : 4;
}

// the same of tools that touch the first model
int compare_touching(bool flip) {
  const auto opened = greenloop::Model::open(recorded[0].model);
  if (!opened) {
    return 1;
  }
  const auto run = greenloop::run_touching_script(
      opened.model, greenloop::TouchingScript::limits(greenloop::touching_contacts, greenloop::touching_iterations),
      arena, greenloop::touching_cycles, 1, flip);
  std::printf("%s, tools: %" PRIu64 " contacts with a force, arena %zu bytes\ndigest %016" PRIx64
              ", expected %016" PRIx64 "\n",
              this_build, run.contacts, run.memory_bytes, run.digest, greenloop::touching_digest);
  if (run.error != nullptr) {
    std::printf("%s\n", run.error);
    return 1;
  }
  return run.digest == greenloop::touching_digest ? 0 : 4;
}

float state[2][8];
greenloop::Vec3 moved[3][91];

// the same of impulses on the recorded motions
int compare_impulses(bool flip) {
  const auto opened = greenloop::Model::open(std::as_bytes(std::span(recorded_motion)));
  if (!opened) {
    return 1;
  }
  const auto run = greenloop::run_impulse_script(
      opened.model, {}, arena, {state[0], state[1], moved[0], moved[1], moved[2]}, greenloop::impulse_cycles, 1, flip);
  std::printf("%s, impulses: %" PRIu64 " followed, arena %zu bytes\ndigest %016" PRIx64 ", expected %016" PRIx64 "\n",
              this_build, run.entered, run.memory_bytes, run.digest, greenloop::impulse_digest);
  if (run.error != nullptr) {
    std::printf("%s\n", run.error);
    return 1;
  }
  return run.digest == greenloop::impulse_digest ? 0 : 4;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || std::strcmp(argv[1], this_build) != 0) {
    std::printf("this program is compiled as %s\n", this_build);
    return 2;
  }
  if (!processor_runs_this()) {
    std::printf("this processor lacks the instructions of %s: nothing was compared\n", this_build);
    return 3;
  }
  const bool flip = argc > 2 && std::strcmp(argv[2], "--flip-bit") == 0;
  int status = 0;
  for (const Recorded& of : recorded) {
    const int of_model = compare(of, flip && &of == std::end(recorded) - 1);
    status = of_model == 0 ? status : of_model;
  }
  for (const int of_run : {compare_touching(flip), compare_impulses(flip)}) {
    status = of_run == 0 ? status : of_run;
  }
  return status;
}
