#include "runtime/compliance/mirrored_couplings.hpp"

#include <cstring>

#include "formats/ready/mirrored_couplings.hpp"
#include "formats/stored_blocks.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr std::size_t padding = 16;  // bytes that a load may reach beyond a block

std::uint32_t index_bytes(const ModelView& view) { return view.domain_count <= 0x10000 ? 2 : 4; }

void store_row(const ModelView& view, void* index, std::uint32_t at, std::uint32_t row) {
  if (index_bytes(view) == 2) {
    static_cast<std::uint16_t*>(index)[at] = static_cast<std::uint16_t>(row);
  } else {
    static_cast<std::uint32_t*>(index)[at] = row;
  }
}

// element k of a block that is zero yet
void store_value(std::uint32_t bits, std::byte* block, std::uint32_t k, std::int16_t value) {
  if (bits == 4) {
    block[k / 2] |= static_cast<std::byte>((value & 15) << (k % 2 == 0 ? 0 : 4));
  } else if (bits == 8) {
    block[k] = static_cast<std::byte>(value);
  } else {
    std::memcpy(block + 2 * std::size_t{k}, &value, sizeof value);
  }
}

template <unsigned N>
void store_transposed(const CouplingsView& from, std::uint32_t bits, std::uint32_t position, std::byte* block) {
  for (std::uint32_t k = 0; k < N * N; ++k) {
    store_value(bits, block, N * (k % N) + k / N, stored_value<N>(from, bits, position, k));
  }
}

}  // namespace

template <unsigned N>
void MirroredCouplingsMaker<N>::carve(Arena& arena, const ModelView& view, const BaseColumns& base) noexcept {
  for (std::uint32_t layer = 0; view.ready.read == nullptr && layer < layout::layers; ++layer) {
    const std::uint64_t blocks = count_mirrored(view, layer, base, nullptr);
    begin_[layer] = arena.take<std::uint32_t>(view.domain_count + std::uint64_t{1});
    index_[layer] = arena.take<std::byte>(index_bytes(view) * blocks);
    value_[layer] = arena.take_zeroed<std::byte>(layout::block_bytes(N, layout::value_bits[layer]) * blocks + padding);
  }
}

template <unsigned N>
MirroredCouplings MirroredCouplingsMaker<N>::make(const ModelView& view, const BaseColumns& base,
                                                  const std::uint8_t* read) noexcept {
  if (view.ready.read != nullptr) {
    return view.ready.mirrored;
  }
  MirroredCouplings mirrored;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const std::uint32_t bits = layout::value_bits[layer];
    std::uint32_t* const begin = begin_[layer];
    std::memset(begin, 0, sizeof(std::uint32_t) * (view.domain_count + std::size_t{1}));
    visit_mirrored(view, layer, base, read,
                   [&](const CouplingsView&, std::uint32_t row, std::uint32_t, std::uint32_t) { ++begin[row + 1]; });
    for (std::uint32_t i = 0; i < view.domain_count; ++i) {
      begin[i + 1] += begin[i];
    }
    // each begin moves to its end, where the next one begins
    visit_mirrored(view, layer, base, read,
                   [&](const CouplingsView& from, std::uint32_t row, std::uint32_t column, std::uint32_t position) {
                     const std::uint32_t at = begin[row]++;
                     store_row(view, index_[layer], at, column);
                     store_transposed<N>(from, bits, position, value_[layer] + layout::block_bytes(N, bits) * at);
                   });
    std::memmove(begin + 1, begin, sizeof(std::uint32_t) * view.domain_count);
    begin[0] = 0;
    mirrored.layer[layer] = {.columns = view.domain_count,
                             .rows = view.domain_count,
                             .index_bytes = index_bytes(view),
                             .begin = begin,
                             .index = index_[layer],
                             .value = value_[layer]};
  }
  return mirrored;
}

template class MirroredCouplingsMaker<1>;
template class MirroredCouplingsMaker<3>;

void mark_read(const Refinement& refinement, Touched& touched, std::uint8_t* read) noexcept {
  const ModelView& view = *refinement.view;
  std::memset(read, 0, view.domain_count);
  for (std::uint32_t place = 0; place < view.domain_count; ++place) {
    const LevelView& level = view.level[refinement.level[place]];
    if ((level.nodes[place - level.domain_begin].flags & layout::node_read) == 0) {
      continue;
    }
    const std::uint32_t column = make_column(view.levels - 1, place);
    touch(refinement, &column, 1, touched);
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
        read[touched.list[q][k]] = 1;
      }
    }
    clear(touched);
  }
}

}  // namespace greenloop
