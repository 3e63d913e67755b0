#include "runtime/compliance/mirrored_couplings.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/testing/placed_body.hpp"
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

TEST_CASE("the mirrored couplings are the stored ones, transposed, each once, rows increasing") {
  for (const layout::Wavelet kind : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = kind});
    const ModelView& view = model.view();
    const PlacedBody placed(view);
    MirroredCouplingsMaker<3> maker;
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
          const LevelView& level = view.level[placed.body->refinement.level[row]];
          const std::uint32_t stored = find_row(level.couplings[layer], row - level.domain_begin, j);
          REQUIRE(stored != layout::none);
          for (std::uint32_t k = 0; k < 9; ++k) {
            CHECK(stored_value<3>(mirrored, layout::value_bits[layer], at, k) ==
                  stored_value<3>(level.couplings[layer], layout::value_bits[layer], stored, 3 * (k % 3) + k / 3));
          }
        }
      }
    }
  }
}

TEST_CASE("blocks that move what nobody reads are left out of the mirrored couplings") {
  const TestModel model({.levels = 4, .read_above = 0.6});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  Body& body = *placed.body;
  std::vector<std::uint8_t> read(view.domain_count);
  mark_read(body.refinement, body.touched, read.data());
  std::uint64_t unread = 0;
  for (const std::uint8_t byte : read) {
    unread += byte == 0 ? 1 : 0;
  }
  CHECK(unread > 10);
  for (const CouplingsView& mirrored : body.mirrored.layer) {
    for (std::uint32_t at = 0; at < mirrored.begin[view.domain_count]; ++at) {
      CHECK(read[stored_row(mirrored, at)] == 1);
    }
  }
}

}  // namespace
}  // namespace greenloop
