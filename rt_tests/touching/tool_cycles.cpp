// tool_cycles MODEL.gloop [--cycles N] [--seed N]: random tools of all shapes about a body, bad poses and starved
// budgets among them; checks every answer. Prints what was met.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "formats/write/model_file.hpp"
#include "rt_tests/harness/touching_run.hpp"
#include "rt_tests/harness/touching_script.hpp"

namespace greenloop {
namespace {

unsigned long long number(std::uint64_t value) { return value; }

int run(const char* file, std::uint64_t cycles, std::uint64_t seed) {
  const AlignedBytes bytes = load_file(file);
  const auto opened = Model::open(bytes.span());
  if (!opened) {
    std::fprintf(stderr, "tool_cycles: %s: its %s is not what a model has\n", file, opened.result.field);
    return 2;
  }
  const ContactBody::Limits limits = TouchingScript::limits(64, 50);
  AlignedBytes memory(ContactBody::required(opened.model, limits).bytes);
  const TouchingRun ran =
      run_touching_script(opened.model, limits, {memory.data(), memory.size()}, cycles, seed, false);
  std::printf(
      "%llu cycles, seed %llu: %llu contacts with a force, %llu of them slipping; friction over its cone by %.1g",
      number(ran.cycle), number(seed), number(ran.contacts), number(ran.slipping), ran.most_over_cone);
  std::printf("; steps by status:");
  for (const std::uint64_t count : ran.by_status) std::printf(" %llu", number(count));
  std::printf("; digest %016llx\n", number(ran.digest));
  if (ran.error != nullptr) {
    std::printf("cycle %llu: %s\n", number(ran.cycle - 1), ran.error);
    return 1;
  }
  const auto count = [&](Status status) { return ran.by_status[static_cast<std::size_t>(status)]; };
  const bool has_tried = ran.contacts > cycles && ran.slipping > cycles / 10 && count(Status::ok) > 0 &&
                         count(Status::coarser) > 0 && count(Status::held_over_budget) > 0 &&
                         count(Status::held_out_of_range) > 0 && count(Status::held_not_finite) > 0;
  if (!has_tried) std::printf("the script did not meet all it is meant to meet\n");
  return has_tried ? 0 : 1;
}

}  // namespace
}  // namespace greenloop

int main(int count, char** argument) {
  std::uint64_t cycles = 20000, seed = 1;
  for (int i = 2; i + 1 < count; i += 2) {
    const std::string_view name(argument[i]);
    std::uint64_t& value = name == "--seed" ? seed : cycles;
    value = std::strtoull(argument[i + 1], nullptr, 10);
  }
  if (count < 2) return 2;
  try {
    return greenloop::run(argument[1], cycles, seed);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tool_cycles: %s\n", error.what());
    return 2;
  }
}
