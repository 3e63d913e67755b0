#include "runtime/newest.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace greenloop {
namespace {

/// A payload long enough to be torn: every word repeats the same number.
struct Message {
  std::array<std::uint64_t, 64> word{};
};

Message message(std::uint64_t number) {
  Message m;
  m.word.fill(number);
  return m;
}

bool whole(const Message& m) {
  for (const std::uint64_t word : m.word) {
    if (word != m.word[0]) return false;
  }
  return true;
}

TEST_CASE("nothing can be taken before something was put, and nothing twice") {
  Newest<Message> newest;
  Message taken;
  CHECK_FALSE(newest.take(taken));
  newest.put(message(7));
  REQUIRE(newest.take(taken));
  CHECK(taken.word[0] == 7);
  CHECK_FALSE(newest.take(taken));
  CHECK(taken.word[0] == 7);
}

TEST_CASE("of several values put, the newest is taken") {
  Newest<Message> newest;
  Message taken;
  for (std::uint64_t burst = 1; burst < 6; ++burst) {
    for (std::uint64_t i = 1; i <= burst; ++i) newest.put(message(10 * burst + i));
    REQUIRE(newest.take(taken));
    CHECK(taken.word[0] == 11 * burst);
    CHECK_FALSE(newest.take(taken));
  }
}

TEST_CASE("between threads values arrive whole, in order, and the last one always") {
  constexpr std::uint64_t last = 200000;
  Newest<Message> newest;
  std::thread writer([&newest] {
    for (std::uint64_t i = 1; i <= last; ++i) newest.put(message(i));
  });
  std::uint64_t torn = 0, backwards = 0, taken_count = 0;
  Message taken;
  for (std::uint64_t previous = 0; previous < last;) {
    if (!newest.take(taken)) {
      std::this_thread::yield();
      continue;
    }
    ++taken_count;
    torn += !whole(taken);
    backwards += taken.word[0] <= previous;
    previous = taken.word[0];
  }
  writer.join();
  CHECK(torn == 0);
  CHECK(backwards == 0);
  CHECK(taken_count > 1);
  CHECK_FALSE(newest.take(taken));
}

}  // namespace
}  // namespace greenloop
