#include "runtime/compliance/couplings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "formats/stored_blocks.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

SyntheticOptions every_layer(unsigned components) {
  return {.components = components, .levels = 4, .epsilon = 0.002, .quantum = 0.0015};
}

TEST_CASE_TEMPLATE("the blocks of a column in rows with a slot are read as they were written, in every layer",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  const ModelData data = synthetic_model(every_layer(N));
  const TestModel model(encode(data));
  const ModelView& view = model.view();
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    CAPTURE(layer);
    std::size_t seen = 0;
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      const CouplingsData& written = data.levels[q].couplings[layer];
      const CouplingsView& couplings = view.level[q].couplings[layer];
      std::vector<std::uint32_t> slot(couplings.rows, layout::none);
      for (std::uint32_t i = 0; i < slot.size(); i += 3) {
        slot[i] = i / 3;
      }
      std::vector<BlockPlace> places(couplings.rows + 1);
      std::vector<Block<N>> blocks(couplings.rows + 1);
      for (std::uint32_t j = 0; j < couplings.columns; ++j) {
        const std::uint32_t count =
            load_slotted<N>(couplings, layer, j, slot.data(), couplings.rows, places.data(), blocks.data());
        std::uint32_t n = 0;
        for (std::uint32_t b = written.begin[j]; b < written.begin[j + 1]; ++b) {
          if (written.index[b] % 3 != 0) {
            continue;
          }
          REQUIRE(n < count);
          CHECK(places[n].target == written.index[b] / 3);
          for (std::uint32_t k = 0; k < N * N; ++k) {
            const int value = written.value[N * N * std::size_t{b} + k];
            CHECK(stored_value<N>(couplings, layout::value_bits[layer], b, k) == value);
            const float scaled = block_factor<N>(data.info, layer) * component(blocks[n].column[k / N], k % N);
            CHECK(scaled == data.info.quantum[layer] * static_cast<float>(value));
          }
          ++n;
        }
        CHECK(n == count);
        seen += count;
      }
    }
    CHECK(seen > 5);
  }
}

// whose sum of the t largest is `exact` or at most a 32nd more
bool bounds(std::uint64_t bound, std::uint64_t exact) { return bound >= exact && bound <= exact + exact / 32; }

void check_largest(const ValueCounts<>& counts, std::vector<std::uint32_t> values) {
  std::sort(values.rbegin(), values.rend());
  CHECK(counts.most() == values.front());
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < values.size(); ++t) {
    CHECK(bounds(counts.largest(t), sum));
    sum += values[t];
  }
  CHECK(bounds(counts.largest(values.size() + 5), sum));
}

TEST_CASE("the largest numbers of blocks of a level are counted, from both sides") {
  const ModelData data = synthetic_model(every_layer(3));
  const TestModel model(encode(data));
  const ModelView& view = model.view();
  BaseColumns base;  // as if the 8-bit blocks of level 0's rows stood in tiles
  base.columns = view.level[0].counts->domain_count;
  base.holds[BaseColumns::quantum_layer] = true;
  std::uint32_t longest_column = 0;
  // [coefficient]
  std::vector<std::uint32_t> own(view.domain_count);
  std::vector<std::uint32_t> in_tiles(view.domain_count);
  // [other][coefficient] with levels up to it
  std::vector<std::vector<std::uint32_t>> blocks(view.levels, std::vector<std::uint32_t>(view.domain_count));
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsData& couplings = data.levels[q].couplings[layer];
      for (std::uint32_t j = 0; j + 1 < couplings.begin.size(); ++j) {
        longest_column = std::max(longest_column, couplings.begin[j + 1] - couplings.begin[j]);
        for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          const std::uint32_t column = view.level[q].domain_begin + j;
          const std::uint32_t row = couplings.index[b];
          ++own[column];
          in_tiles[row] += base.holds[layer] && row < base.columns ? 1 : 0;
          for (std::uint32_t other = 0; other < view.levels; ++other) {
            blocks[other][column] += row < domain_up_to(view, other) ? 1 : 0;
            blocks[other][row] += q <= other ? 1 : 0;
          }
        }
      }
    }
  }
  const CouplingCounts counts = count_couplings(view);
  CHECK(counts.countable);
  CHECK(counts.longest_column == longest_column);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const auto of_level = [&](const std::vector<std::uint32_t>& all) {
      return std::vector(all.begin() + view.level[q].domain_begin, all.begin() + domain_up_to(view, q));
    };
    ValueCounts<> stored;
    count_stored(view, q, stored);
    check_largest(stored, of_level(own));
    for (std::uint32_t other = 0; other < view.levels; ++other) {
      ValueCounts<> all;
      count_blocks(view, q, {0, other}, {}, all);
      check_largest(all, of_level(blocks[other]));
    }
    std::vector<std::uint32_t> without_tiles = of_level(blocks[view.levels - 1]);
    const std::vector<std::uint32_t> left_out = of_level(in_tiles);
    std::transform(without_tiles.begin(), without_tiles.end(), left_out.begin(), without_tiles.begin(), std::minus<>());
    ValueCounts<> beside_tiles;
    count_blocks(view, q, {0, view.levels - 1}, base, beside_tiles);
    check_largest(beside_tiles, without_tiles);
  }
}

}  // namespace
}  // namespace greenloop
