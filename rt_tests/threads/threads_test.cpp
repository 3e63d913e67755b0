// The thread rules of docs/loop.md: any number of bodies on one model, a thread each; and a fast loop that hands its
// newest contacts to a slow one. Compiled a second time under ThreadSanitizer.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "runtime/newest.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr Elastostatic::Limits limits{.max_contacts = 12, .cached_factors = 3};

// what the fast loop hands over
struct Touch {
  std::uint32_t cycle = 0;
  std::uint32_t count = 0;
  std::array<Constraint, limits.max_contacts> contact{};

  [[nodiscard]] std::span<const Constraint> contacts() const { return {contact.data(), count}; }
};

// a hand that moves over the body
Touch touch_at(std::uint32_t cycle, const std::vector<std::uint32_t>& nodes) {
  Touch touch{.cycle = cycle, .count = 1 + cycle / 16 % limits.max_contacts};
  for (std::uint32_t i = 0; i < touch.count; ++i) {
    const float depth = 0x1p-20F * static_cast<float>(cycle % 100 + i);
    touch.contact[i] = {nodes[(cycle / 10 + i) % nodes.size()], {depth, -depth, depth / 2}};
  }
  return touch;
}

// a loop of its own kind of contacts and budgets for every seed
std::uint64_t digest_of_loop(const TestModel& model, std::uint64_t seed) {
  const auto nodes = model.touchable();
  std::mt19937_64 random(seed);
  TestBody body(model, limits);
  const Elastostatic::Requirement& need = body.requirement();
  std::uint64_t digest = empty_hash;
  for (int i = 0; i < 400; ++i) {
    const Touch touch = touch_at(static_cast<std::uint32_t>(random() % 4000), nodes);
    const std::uint64_t work = need.least_work + random() % (need.worst_work[2] >> random() % 8);
    const Elastostatic::StepReport report = body.step(touch.contacts(), work, i % 3 == 0);
    digest = hash_step(digest, report, body.force(), body.field());
  }
  return digest;
}

TEST_CASE("bodies on one model, a thread each, answer as each does alone") {
  constexpr std::size_t count = 4;
  const TestModel model({.levels = 3});
  std::array<std::uint64_t, count> alone{};
  for (std::size_t i = 0; i < count; ++i) {
    alone[i] = digest_of_loop(model, i);
  }
  CHECK(alone[0] != alone[1]);
  std::array<std::uint64_t, count> together{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) {
    threads.emplace_back([&, i] { together[i] = digest_of_loop(model, i); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  CHECK(together == alone);
}

struct FieldDigest {
  std::uint32_t cycle;
  std::uint64_t digest;
};

std::uint64_t field_digest(TestBody& body, const Touch& touch) {
  const Elastostatic::StepReport report = body.step(touch.contacts(), any_budget);
  REQUIRE(report.status == Status::ok);
  return hash_bytes(empty_hash, std::as_bytes(std::span<const float>(body.field())));
}

// the fast loop: forces only, every cycle; after the first it waits until `taken`, for a slow loop that begins late
template <class Taken>
std::uint64_t run_force_loop(const TestModel& model, std::uint32_t cycles, Newest<Touch>& newest, Taken taken) {
  const auto nodes = model.touchable();
  TestBody body(model, limits);
  std::uint64_t digest = empty_hash;
  for (std::uint32_t cycle = 0; cycle < cycles; ++cycle) {
    const Touch touch = touch_at(cycle, nodes);
    newest.put(touch);
    while (!taken()) {
      std::this_thread::yield();
    }
    const Elastostatic::StepReport report = body.step(touch.contacts(), any_budget, false);
    digest = hash_step(digest, report, body.force(), {});
  }
  return digest;
}

// the slow loop: the whole field of the newest contacts, as often as it can
std::vector<FieldDigest> run_field_loop(const TestModel& model, std::uint32_t cycles, Newest<Touch>& newest,
                                        std::atomic<bool>& taken) {
  TestBody body(model, limits);
  std::vector<FieldDigest> fields;
  for (Touch touch; touch.cycle + 1 < cycles;) {
    if (newest.take(touch)) {
      taken = true;
      fields.push_back({touch.cycle, field_digest(body, touch)});
    } else {
      std::this_thread::yield();
    }
  }
  return fields;
}

TEST_CASE("a slow loop shows the fields of a fast loop's newest contacts") {
  constexpr std::uint32_t cycles = 3000;
  const TestModel model({.levels = 3});
  Newest<Touch> newest;
  std::vector<FieldDigest> fields;
  std::atomic<bool> taken = false;
  std::thread slow([&] { fields = run_field_loop(model, cycles, newest, taken); });
  const std::uint64_t forces = run_force_loop(model, cycles, newest, [&] { return taken.load(); });
  slow.join();

  Newest<Touch> nobody_takes;
  CHECK(run_force_loop(model, cycles, nobody_takes, [] { return true; }) == forces);
  const auto nodes = model.touchable();
  TestBody reference(model, limits);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    wrong += i > 0 && fields[i].cycle <= fields[i - 1].cycle ? 1 : 0;
    wrong += field_digest(reference, touch_at(fields[i].cycle, nodes)) != fields[i].digest ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(fields.size() > 1);
  CHECK(fields.back().cycle == cycles - 1);
}

// what Newest is not: one buffer and a mark
template <class T>
class OneBuffer {
 public:
  void put(const T& value) {
    buffer_ = value;
    fresh_.store(true, std::memory_order_release);
  }
  bool take(T& value) {
    if (!fresh_.exchange(false, std::memory_order_acquire)) {
      return false;
    }
    value = buffer_;
    return true;
  }

 private:
  T buffer_{};
  std::atomic<bool> fresh_{false};
};

// negative control, run by name: ThreadSanitizer has to report it
TEST_CASE("a hand-over through one buffer races" * doctest::skip()) {
  constexpr std::uint32_t last = 100000;
  OneBuffer<Touch> buffer;
  const std::vector<std::uint32_t> nodes(20);
  std::thread writer([&] {
    for (std::uint32_t cycle = 1; cycle <= last; ++cycle) {
      buffer.put(touch_at(cycle, nodes));
    }
  });
  for (Touch touch; touch.cycle < last;) {
    if (!buffer.take(touch)) {
      std::this_thread::yield();
    }
  }
  writer.join();
}

}  // namespace
}  // namespace greenloop
