#include "runtime/compliance/couplings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
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

TEST_CASE("blocks are counted by pairs of levels, from both sides") {
  const ModelData data = synthetic_model(every_layer(3));
  const TestModel model(encode(data));
  const ModelView& view = model.view();
  const auto level_of_place = [&view](std::uint32_t place) {
    std::uint32_t q = 0;
    while (place >= domain_up_to(view, q)) {
      ++q;
    }
    return q;
  };
  // [coefficient][level]
  std::vector<std::vector<std::uint32_t>> stored(view.domain_count, std::vector<std::uint32_t>(view.levels));
  std::uint32_t longest_column = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsData& couplings = data.levels[q].couplings[layer];
      for (std::uint32_t j = 0; j + 1 < couplings.begin.size(); ++j) {
        longest_column = std::max(longest_column, couplings.begin[j + 1] - couplings.begin[j]);
        for (std::uint32_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          const std::uint32_t column = view.level[q].domain_begin + j;
          const std::uint32_t row = couplings.index[b];
          ++stored[column][level_of_place(row)];
          ++stored[row][q];
        }
      }
    }
  }
  const CouplingCounts counts = count_couplings(view);
  CHECK(counts.countable);
  CHECK(counts.longest_column == longest_column);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t other = 0; other < view.levels; ++other) {
      LevelPair in_all;
      for (std::uint32_t i = view.level[q].domain_begin; i < domain_up_to(view, q); ++i) {
        in_all.all += stored[i][other];
        in_all.most = std::max(in_all.most, stored[i][other]);
      }
      CHECK(counts.stored[q][other].all == in_all.all);
      CHECK(counts.stored[q][other].most == in_all.most);
    }
  }
}

}  // namespace
}  // namespace greenloop
