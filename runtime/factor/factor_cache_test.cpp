#include "runtime/factor/factor_cache.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

class SmallCache {
 public:
  explicit SmallCache(std::uint32_t factors) {
    Arena counting;
    cache.carve<3>(counting, factors, 4);
    memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory_.data());
    cache.carve<3>(arena, factors, 4);
  }

  bool has(std::vector<std::uint32_t> columns, std::uint32_t level = 2) {
    return cache.find(set_of(columns, level)) != nullptr;
  }
  // what a step does
  void use(std::vector<std::uint32_t> columns, std::uint32_t level = 2) {
    const ColumnSet set = set_of(columns, level);
    Factor* found = cache.find(set);
    if (found != nullptr) {
      cache.use(*found);
    } else {
      cache.keep(cache.make_room(set), set);
    }
  }

  FactorCache cache;

 private:
  static ColumnSet set_of(std::vector<std::uint32_t>& columns, std::uint32_t level) {
    for (std::uint32_t& column : columns) {
      column = make_column(level, column);
    }
    return {static_cast<std::uint32_t>(columns.size()), columns.data()};
  }
  AlignedBytes memory_;
};

TEST_CASE("the least recently used factor makes room") {
  SmallCache cache(3);
  cache.use({1, 2});
  cache.use({3});
  cache.use({4, 5, 6});
  CHECK(cache.has({1, 2}));
  cache.use({1, 2});
  cache.use({7});
  CHECK(cache.has({1, 2}));
  CHECK_FALSE(cache.has({3}));
  CHECK(cache.has({4, 5, 6}));
  CHECK(cache.has({7}));
}

TEST_CASE("the last set survives any number of unrelated lookups and one unrelated set") {
  SmallCache cache(2);
  cache.use({9});
  for (std::uint32_t k = 10; k < 100; ++k) {
    CHECK_FALSE(cache.has({k}));
    cache.use({k});
    cache.use({9});
    CHECK(cache.has({9}));
  }
}

TEST_CASE("level, length and order of the key all count") {
  SmallCache cache(3);
  cache.use({1, 2});
  CHECK_FALSE(cache.has({1, 2}, 1));
  CHECK_FALSE(cache.has({1}));
  CHECK_FALSE(cache.has({1, 2, 3}));
  CHECK_FALSE(cache.has({2, 1}));
}

TEST_CASE("room that was made but not kept is empty") {
  SmallCache cache(1);
  cache.use({1});
  const std::uint32_t column = 2;
  static_cast<void>(cache.cache.make_room({1, &column}));
  CHECK_FALSE(cache.has({1}));
  CHECK_FALSE(cache.has({2}));
}

}  // namespace
}  // namespace greenloop
