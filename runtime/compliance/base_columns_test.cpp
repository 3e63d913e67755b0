#include "runtime/compliance/base_columns.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <random>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

int element(const BaseColumns& base, std::uint32_t column, std::uint32_t row, std::uint32_t k) {
  const std::byte* const tile = base.column<3>(column) + BaseColumns::tile_bytes<3> * (row / BaseColumns::width);
  return static_cast<std::int8_t>(tile[8 * k + row % BaseColumns::width]);
}

TEST_CASE("columns of level 0 are whole where nearly all of their couplings exist, and hold each, transposed") {
  // quanta of 8 and 4 bits that differ, and one
  for (const bool one_quantum : {false, true}) {
    ModelData data = synthetic_model({.levels = 5, .epsilon = 0});
    if (one_quantum) {
      data.info.quantum[3] = data.info.quantum[2];
    }
    const TestModel model(encode(data));
    const ModelView& view = model.view();
    const PlacedBody placed(view);
    const BaseColumns& base = placed.body->base;
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
            for (std::uint32_t k = 0; k < 9; ++k) {
              const int stored = stored_value<3>(couplings, layout::value_bits[layer], position, k);
              CHECK(element(base, row, view.level[q].domain_begin + j, 3 * (k % 3) + k / 3) == stored);
              found += stored != 0 ? 1 : 0;
            }
          });
        }
      }
    }
    for (std::uint32_t i = 0; i < BaseColumns::tile_bytes<3> * base.tiles * base.columns; ++i) {
      elements += base.value[i] != std::byte{0} ? 1 : 0;
    }
    CHECK(found == elements);
  }
}

TEST_CASE("bodies that are small, or whose level 0 is coupled to few coefficients, have no whole columns") {
  for (const SyntheticOptions& options :
       {SyntheticOptions{.levels = 5, .epsilon = 0.05}, {.levels = 4, .epsilon = 0}}) {
    const TestModel model(options);
    CHECK(PlacedBody(model.view()).body->base.columns == 0);
  }
}

TEST_CASE("the fastest sum of tiles has the bits of the one of every processor") {
  std::mt19937_64 random(3);
  for (std::uint32_t count = 0; count < 9; ++count) {
    std::vector<std::byte> tiles(BaseColumns::tile_bytes<3> * count + 16);
    for (std::byte& value : tiles) {
      value = static_cast<std::byte>(random() % 255 - 127);
    }
    AlignedBytes plain_memory(sizeof(TileSums<3>) * 9), fast_memory(sizeof(TileSums<3>) * 9);
    auto* const plain = reinterpret_cast<TileSums<3>*>(plain_memory.data());
    auto* const fast = reinterpret_cast<TileSums<3>*>(fast_memory.data());
    for (int round = 0; round < 20; ++round) {
      const auto number = [&] {
        return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 1e-3F;
      };
      const Float4 force = {number(), number(), number(), 0.0F};
      add_tiles<3>(tiles.data(), count, force, plain);
      fastest_add_tiles<3>()(tiles.data(), count, force, fast);
    }
    CHECK(std::memcmp(plain, fast, sizeof(TileSums<3>) * 9) == 0);
    bool moved = false;
    for (std::uint32_t t = 0; t < count; ++t) {
      moved = moved || plain[t].of[2][1][3] != 0;
    }
    CHECK(moved == (count > 0));
  }
}

TEST_CASE("every element of a tile moves its own coefficient and component") {
  for (const AddTiles<3> add : {AddTiles<3>{add_tiles<3>}, fastest_add_tiles<3>()}) {
    for (std::uint32_t at = 0; at < BaseColumns::tile_bytes<3>; ++at) {
      std::vector<std::byte> tile(BaseColumns::tile_bytes<3> + 16);
      tile[at] = std::byte{0xfb};  // -5
      alignas(32) TileSums<3> sums{};
      add(tile.data(), 1, Float4{1.0F, 2.0F, 4.0F, 0.0F}, &sums);
      const std::uint32_t k = at / 8;
      for (std::uint32_t r = 0; r < 3; ++r) {
        for (std::uint32_t i = 0; i < 8; ++i) {
          const bool moved = r == k % 3 && i == at % 8;
          CHECK(float{sums.of[r][i / 4][i % 4]} == (moved ? -5.0F * static_cast<float>(1U << k / 3) : 0.0F));
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenloop
