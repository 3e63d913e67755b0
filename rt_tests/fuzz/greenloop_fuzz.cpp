// greenloop-fuzz DOOR SECONDS [SEED [FIRST]]: random changes of right files, tried with all of our code compiled with
// sanitizers. Input i is made of SEED and i alone; a finding names both, and FIRST begins there. An input that takes
// more than ten seconds, or more than 1 GB at once, is a finding too.
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

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

int main(int count, char** arguments) {
  const auto number = [&](int k, unsigned long long otherwise) {
    return count > k ? std::strtoull(arguments[k], nullptr, 10) : otherwise;
  };
  door_name = count > 1 ? arguments[1] : "";
  const auto door = door_of(door_name);
  if (!door || count < 3) {
    std::fprintf(stderr, "greenloop-fuzz mesh|model|report|scene|store|transport SECONDS [SEED [FIRST]]\n");
    return 2;
  }
  seed = number(3, 1);
  index_now = number(4, 0);
  __sanitizer_set_death_callback(say_where);
  std::signal(SIGALRM, too_slow);
  const std::time_t end = std::time(nullptr) + static_cast<std::time_t>(number(2, 1));
  unsigned long long tried = 0, taken = 0;
  for (; std::time(nullptr) < end; ++index_now, ++tried) {
    alarm(10);
    greenloop::Random random(seed * 0x9e3779b97f4a7c15ULL + index_now);
    taken += door->try_one(random) ? 1 : 0;
  }
  alarm(0);
  std::printf("%s: %llu inputs from seed %llu, %llu taken, no finding\n", door_name.c_str(), tried, seed, taken);
  // what is always refused, or never, tries nothing
  constexpr unsigned long long enough = 1000;
  return tried < enough || (taken > 0 && taken < tried) ? 0 : 1;
}
