// greenloop-fuzz DOOR SECONDS [SEED [FIRST]] [--json]: random changes of right files, tried with all of our code
// compiled with sanitizers. Input i is made of SEED and i alone; a finding names both, and FIRST begins there. An input
// that takes more than ten seconds, or more than 1 GB at once, is a finding too.
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "rt_tests/fuzz/doors.hpp"

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the sanitizers' names
[[gnu::visibility("default")]] const char* __asan_default_options();
// libhdf5 believes sizes of its own metadata, and can do without the memory; a `new` of ours that fails is a finding
const char* __asan_default_options() {
  return "max_allocation_size_mb=1024:allocator_may_return_null=1:detect_leaks=0:handle_abort=1";
}
void __sanitizer_set_death_callback(void (*callback)());
// NOLINTEND(bugprone-reserved-identifier)
}

namespace {

std::string door_name;
unsigned long long seed = 1, index_now = 0;

void say_where() {
  std::fprintf(stderr, "greenloop-fuzz %s 1 %llu %llu: a finding\n", door_name.c_str(), seed, index_now);
}

void too_slow(int) { std::abort(); }

struct KnownDoor {
  const char* name;
  std::unique_ptr<greenloop::Door> (*make)();
};

constexpr std::array doors{
    KnownDoor{"mesh", greenloop::mesh_door},     KnownDoor{"model", greenloop::model_door},
    KnownDoor{"report", greenloop::report_door}, KnownDoor{"scene", greenloop::scene_door},
    KnownDoor{"store", greenloop::store_door},   KnownDoor{"transport", greenloop::transport_door}};

std::unique_ptr<greenloop::Door> door_of(const std::string& name) {
  for (const KnownDoor& known : doors) {
    if (name == known.name) return known.make();
  }
  return nullptr;
}

}  // namespace

namespace greenloop {

void require_right(bool right, const char* what) {
  if (right) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace greenloop

namespace {

struct Tried {
  unsigned long long inputs = 0, taken = 0;

  // what is always refused, or never, tries nothing
  [[nodiscard]] bool held() const { return inputs < 1000 || (taken > 0 && taken < inputs); }
};

// an exception that escapes is a finding
Tried try_inputs(greenloop::Door& door, unsigned seconds) noexcept {
  Tried tried;
  for (const std::time_t end = std::time(nullptr) + seconds; std::time(nullptr) < end; ++index_now, ++tried.inputs) {
    alarm(10);
    greenloop::Random random(seed * 0x9e3779b97f4a7c15ULL + index_now);
    tried.taken += door.try_one(random) ? 1 : 0;
  }
  alarm(0);
  return tried;
}

void print(const Tried& tried, bool json) {
  if (json) {
    greenloop::print_result(greenloop::json_text(nlohmann::ordered_json{{"verdict", tried.held() ? "HELD" : "VIOLATED"},
                                                                        {"door", door_name},
                                                                        {"seed", seed},
                                                                        {"inputs", tried.inputs},
                                                                        {"taken", tried.taken}}) +
                            "\n");
    return;
  }
  greenloop::print_result(door_name + ": " + std::to_string(tried.inputs) + " inputs from seed " +
                          std::to_string(seed) + ", " + std::to_string(tried.taken) + " taken, no finding\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Random changes of right files, tried by all code that reads them, compiled with sanitizers.",
               "greenloop-fuzz");
  std::vector<std::string> names(doors.size());
  std::transform(doors.begin(), doors.end(), names.begin(), [](const KnownDoor& known) { return known.name; });
  unsigned seconds = 1;
  bool json = false;
  app.add_option("DOOR", door_name, "what reads")->required()->check(CLI::IsMember(names));
  app.add_option("SECONDS", seconds, "to try")->required()->check(CLI::Range(1U, 1U << 30));
  app.add_option("SEED", seed, "of the changes")->capture_default_str();
  app.add_option("FIRST", index_now, "input to begin with")->capture_default_str();
  app.add_flag("--json", json, "machine-readable result");
  return greenloop::run_program(app, argc, argv, [&] {
    const auto door = door_of(door_name);
    __sanitizer_set_death_callback(say_where);
    std::signal(SIGALRM, too_slow);
    const Tried tried = try_inputs(*door, seconds);
    print(tried, json);
    return tried.held() ? 0 : 1;
  });
}
