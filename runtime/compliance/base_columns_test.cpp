#include "runtime/compliance/base_columns.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <random>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

template <unsigned N>
int element(const BaseColumns& base, std::uint32_t column, std::uint32_t row, std::uint32_t k) {
  const std::byte* const tile = base.column<N>(column) + BaseColumns::tile_bytes<N> * (row / BaseColumns::width);
  return static_cast<std::int8_t>(tile[8 * k + row % BaseColumns::width]);
}

TEST_CASE_TEMPLATE("columns of level 0 are whole where nearly all of their couplings exist, and hold each, transposed",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  // quanta of 8 and 4 bits that differ, and one
  for (const bool one_quantum : {false, true}) {
    ModelData data = synthetic_model({.components = N, .levels = 5, .epsilon = 0});
    if (one_quantum) {
      data.info.quantum[3] = data.info.quantum[2];
    }
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const Rooms<N> rooms(view);
    const BaseColumns& base = rooms.base;
    if (base.columns == 0) {
      CHECK_FALSE(one_quantum);
      continue;
    }
    CHECK(base.columns == view.level[0].counts->domain_count);
    CHECK(base.holds[3] == one_quantum);
    std::uint64_t found = 0;
    std::uint64_t elements = 0;
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      for (std::uint32_t layer = 2; layer < layout::layers; ++layer) {
        const CouplingsView& couplings = view.level[q].couplings[layer];
        for (std::uint32_t j = 0; base.holds[layer] && j < couplings.columns; ++j) {
          visit_rows(couplings, j, 0, base.columns, [&](std::uint32_t row, std::uint32_t position) {
            for (std::uint32_t k = 0; k < N * N; ++k) {
              const int stored = stored_value<N>(couplings, layout::value_bits[layer], position, k);
              CHECK(element<N>(base, row, view.level[q].domain_begin + j, N * (k % N) + k / N) == stored);
              found += stored != 0 ? 1 : 0;
            }
          });
        }
      }
    }
    for (std::uint32_t i = 0; i < BaseColumns::tile_bytes<N> * base.tiles * base.columns; ++i) {
      elements += base.value[i] != std::byte{0} ? 1 : 0;
    }
    CHECK(found == elements);
  }
}

TEST_CASE_TEMPLATE("bodies that are small, or whose level 0 is coupled to few coefficients, have no whole columns",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const SyntheticOptions& options : {SyntheticOptions{.components = N, .levels = 5, .epsilon = 0.05},
                                          {.components = N, .levels = 4, .epsilon = 0}}) {
    const TestModel model(options);
    CHECK(Rooms<N>(model.view()).base.columns == 0);
  }
}

TEST_CASE_TEMPLATE("the fastest sum of tiles has the bits of the one of every processor", Components, One, Three) {
  constexpr unsigned N = Components::value;
  std::mt19937_64 random(3);
  for (std::uint32_t count = 0; count < 9; ++count) {
    std::vector<std::byte> tiles(BaseColumns::tile_bytes<N> * count + 16);
    for (std::byte& value : tiles) {
      value = static_cast<std::byte>(random() % 255 - 127);
    }
    AlignedBytes plain_memory(sizeof(TileSums<N>) * 9), fast_memory(sizeof(TileSums<N>) * 9);
    auto* const plain = reinterpret_cast<TileSums<N>*>(plain_memory.data());
    auto* const fast = reinterpret_cast<TileSums<N>*>(fast_memory.data());
    for (int round = 0; round < 20; ++round) {
      const auto number = [&] {
        return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 1e-3F;
      };
      const float numbers[] = {number(), number(), number()};
      const Vector<N> force = load_vector<N>(numbers);
      add_tiles<N>(tiles.data(), count, force, plain);
      fastest_add_tiles<N>()(tiles.data(), count, force, fast);
    }
    CHECK(std::memcmp(plain, fast, sizeof(TileSums<N>) * 9) == 0);
    bool moved = false;
    for (std::uint32_t t = 0; t < count; ++t) {
      moved = moved || plain[t].of[N - 1][1][3] != 0;
    }
    CHECK(moved == (count > 0));
  }
}

TEST_CASE_TEMPLATE("every element of a tile moves its own coefficient and component", Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const AddTiles<N> add : {AddTiles<N>{add_tiles<N>}, fastest_add_tiles<N>()}) {
    for (std::uint32_t at = 0; at < BaseColumns::tile_bytes<N>; ++at) {
      std::vector<std::byte> tile(BaseColumns::tile_bytes<N> + 16);
      tile[at] = std::byte{0xfb};  // -5
      alignas(32) TileSums<N> sums{};
      const float force[] = {1, 2, 4};
      add(tile.data(), 1, load_vector<N>(force), &sums);
      const std::uint32_t k = at / 8;
      for (std::uint32_t r = 0; r < N; ++r) {
        for (std::uint32_t i = 0; i < 8; ++i) {
          const bool moved = r == k % N && i == at % 8;
          CHECK(float{sums.of[r][i / 4][i % 4]} == (moved ? -5.0F * static_cast<float>(1U << k / N) : 0.0F));
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
