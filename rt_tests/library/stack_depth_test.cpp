// How deep the stack of a step goes, on every way the planner can take: below what docs/loop.md promises. Linked so
// that library functions are looked up at the start: the linker's own stack is not the step's.
#include <doctest/doctest.h>
#include <pthread.h>

#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::size_t promised = 1024;
constexpr std::size_t stack_bytes = 1 << 20;
constexpr unsigned char paint = 0xa5;

// a thread's stack, and what is called on it
struct Painted {
  unsigned char* lowest = nullptr;
  std::function<void()> work;
  std::size_t depth = 0;  // of the work and this call
};

// paints what is below this frame, calls, and looks how far down it was written to
[[gnu::noinline]] void measure(Painted& stack) {
  auto* const frame = static_cast<unsigned char*>(__builtin_frame_address(0));
  constexpr std::size_t own = 512;  // at least what this frame takes
  for (volatile unsigned char* at = stack.lowest; at < frame - own; ++at) {
    *at = paint;
  }
  stack.work();
  const unsigned char* at = stack.lowest;
  while (*at == paint) {
    ++at;
  }
  stack.depth = static_cast<std::size_t>(frame - at);
}

std::size_t depth_of(const std::function<void()>& work) {
  const std::unique_ptr<void, decltype(&std::free)> memory(std::aligned_alloc(4096, stack_bytes), &std::free);
  Painted stack{static_cast<unsigned char*>(memory.get()), work};
  pthread_attr_t attributes;
  REQUIRE(pthread_attr_init(&attributes) == 0);
  REQUIRE(pthread_attr_setstack(&attributes, memory.get(), stack_bytes) == 0);
  pthread_t thread{};
  const auto run = [](void* of) -> void* {
    measure(*static_cast<Painted*>(of));
    return nullptr;
  };
  REQUIRE(pthread_create(&thread, &attributes, run, &stack) == 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  return stack.depth;
}

[[gnu::noinline]] void write_bytes(std::size_t bytes) {
  auto* const local = static_cast<volatile unsigned char*>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < bytes; ++i) {
    local[i] = 0;
  }
}

TEST_CASE("the depth of a stack is measured") {
  const std::size_t shallow = depth_of([] { write_bytes(1000); }), deep = depth_of([] { write_bytes(5000); });
  CHECK(shallow >= 1000);
  CHECK(deep == shallow + 4000);
}

TEST_CASE("a step keeps below the promised depth, whatever it has to do") {
  for (const auto wavelet : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = wavelet});
    TestBody body(model, {.max_contacts = 20, .cached_factors = 2});
    const auto nodes = model.touchable();
    std::vector<float> force(60);
    const auto depth = [&](std::size_t first, std::size_t count, std::uint64_t work) {
      std::vector<Constraint> contacts;
      for (std::size_t i = 0; i < count; ++i) {
        contacts.push_back({nodes[first + i], {1e-3F, 0, -1e-3F}});
      }
      const Elastostatic::Response response{as_vec3(std::span(force).first(3 * count)), as_vec4(body.field())};
      Elastostatic::StepReport report;
      const std::size_t whole = depth_of([&] { report = body.body().step(contacts, {work}, response); });
      CHECK(answered(report.status));
      return whole - depth_of([] {});
    };
    // each set is coarser first, then fresh or made of the last one's factor, then cached
    std::size_t deepest = 0;
    for (const std::size_t count : {0, 1, 2, 19, 20}) {
      for (const std::size_t first : {0, 1, 5}) {
        for (const std::uint64_t work : {body.requirement().least_work, any_budget, any_budget}) {
          deepest = std::max(deepest, depth(first, count, work));
        }
      }
    }
    MESSAGE("deepest stack of a step: ", deepest, " bytes");
    CHECK(deepest > 100);
    CHECK(deepest < promised);
  }
}

}  // namespace
}  // namespace greenloop
