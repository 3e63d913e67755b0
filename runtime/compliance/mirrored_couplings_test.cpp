#include "runtime/compliance/mirrored_couplings.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// position of the block of a row in a column; layout::none if there is none
std::uint32_t find_row(const CouplingsView& view, std::uint32_t column, std::uint32_t row) {
  for (std::uint32_t at = view.columns == 0 ? 0 : view.begin[column];
       at < (view.columns == 0 ? 0 : view.begin[column + 1]); ++at) {
    if (stored_row(view, at) == row) {
      return at;
    }
  }
  return layout::none;
}

TEST_CASE_TEMPLATE("the mirrored couplings are the stored ones, transposed, each once, rows increasing", Components,
                   One, Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    const TestModel model({.components = N, .levels = 4, .wavelet = kind});
    const ModelView& view = model.view();
    const Rooms<N> rooms(view);
    MirroredCouplingsMaker<N> maker;
    Arena counting;
    maker.carve(counting, view, {});
    AlignedBytes memory(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory.data());
    maker.carve(arena, view, {});
    const std::vector<std::uint8_t> read(view.domain_count, 1);
    const MirroredCouplings all = maker.make(view, {}, read.data());
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& mirrored = all.layer[layer];
      REQUIRE(mirrored.begin[view.domain_count] == block_count(view, layer, layer + 1));
      REQUIRE(block_count(view, layer, layer + 1) > 0);
      for (std::uint32_t j = 0; j < view.domain_count; ++j) {
        for (std::uint32_t at = mirrored.begin[j]; at < mirrored.begin[j + 1]; ++at) {
          const std::uint32_t row = stored_row(mirrored, at);
          REQUIRE(row > j);
          REQUIRE((at == mirrored.begin[j] || row > stored_row(mirrored, at - 1)));
          const LevelView& level = view.level[rooms.refinement.level[row]];
          const std::uint32_t stored = find_row(level.couplings[layer], row - level.domain_begin, j);
          REQUIRE(stored != layout::none);
          for (std::uint32_t k = 0; k < N * N; ++k) {
            CHECK(stored_value<N>(mirrored, layout::value_bits[layer], at, k) ==
                  stored_value<N>(level.couplings[layer], layout::value_bits[layer], stored, N * (k % N) + k / N));
          }
        }
      }
    }
  }
}

TEST_CASE_TEMPLATE("blocks that move what nobody reads are left out of the mirrored couplings", Components, One,
                   Three) {
  constexpr unsigned N = Components::value;
  const TestModel model({.components = N, .levels = 4, .read_above = 0.6});
  const ModelView& view = model.view();
  Rooms<N> rooms(view);
  std::vector<std::uint8_t> read(view.domain_count);
  mark_read(rooms.refinement, rooms.touched, read.data());
  std::uint64_t unread = 0;
  for (const std::uint8_t byte : read) {
    unread += byte == 0 ? 1 : 0;
  }
  CHECK(unread > 10);
  for (const CouplingsView& mirrored : rooms.mirrored.layer) {
    for (std::uint32_t at = 0; at < mirrored.begin[view.domain_count]; ++at) {
      CHECK(read[stored_row(mirrored, at)] == 1);
    }
  }
}

}  // namespace
}  // namespace greenloop
