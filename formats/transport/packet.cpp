#include "formats/transport/packet.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "formats/crc32c.hpp"
#include "formats/transport/coupling_blocks.hpp"
#include "formats/transport/couplings_model.hpp"

namespace greenloop::transport {
namespace {

using layout::Partner;
using layout::SectionEntry;
using layout::SectionKind;

constexpr std::uint64_t aligned(std::uint64_t offset) {
  return (offset + layout::alignment - 1) / layout::alignment * layout::alignment;
}

bool is(const PacketSection& section, SectionKind kind) {
  return section.entry.kind == static_cast<std::uint32_t>(kind);
}

// parents before positions before what needs positions
int rank(const PacketSection& section) {
  switch (static_cast<SectionKind>(section.entry.kind)) {
    case SectionKind::nodes:
      return 1;
    case SectionKind::representatives:
    case SectionKind::scales:
      return 2;
    case SectionKind::couplings:
      return 3;
    default:
      return 0;
  }
}

// the layers of one level and partner as bytes again
bool reproduces(const CouplingBlocks& joined, std::span<CouplingsData> layers, std::span<PacketSection*> sections,
                bool write) {
  for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
    take_layer(joined, layer, layers[layer]);
    auto bytes = encode_couplings(layers[layer], joined.columns, joined.rows, joined.dense, "couplings");
    if (write ? bytes.size() != sections[layer]->bytes.size() : bytes != sections[layer]->bytes) return false;
    if (write) sections[layer]->bytes = std::move(bytes);
  }
  return true;
}

}  // namespace

std::uint32_t content_crc(std::span<const PacketSection> sections) {
  std::uint32_t crc = 0;
  for (const PacketSection& section : sections) crc = crc32c(std::as_bytes(std::span(&section.entry, 1)), crc);
  for (const PacketSection& section : sections) crc = crc32c(section.bytes, crc);
  return crc;
}

void PacketModel::code(BitCoder& coder, std::uint32_t q, FileExtent extent, std::vector<PacketSection>& sections,
                       const ModelView* model) {
  code_table(coder, extent, sections);
  std::vector<PacketSection*> order;
  order.reserve(sections.size());
  for (PacketSection& section : sections) order.push_back(&section);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return rank(*a) < rank(*b); });

  std::array<std::vector<PacketSection*>, 3> couplings;
  for (PacketSection* const section : order) {
    const std::uint32_t partner = section->entry.b / layout::strengths;
    if (is(*section, SectionKind::couplings) && section->entry.a == q && partner < couplings.size()) {
      couplings[partner].push_back(section);
    } else {
      code_section(coder, q, *section);
    }
  }
  for (std::uint32_t partner = 0; partner < couplings.size(); ++partner) {
    if (!couplings[partner].empty()) code_couplings_of(coder, q, partner, couplings[partner], model);
  }
  for (PacketSection& section : sections) section.entry.crc = crc32c(section.bytes);
}

void PacketModel::code_table(BitCoder& coder, FileExtent extent, std::vector<PacketSection>& sections) {
  const std::uint64_t room = extent.end - extent.begin;
  const std::uint64_t count = table_.code(coder, sections.size(), 0);
  if (count > room / sizeof(SectionEntry)) throw DamagedPacket("more sections than fit in it");
  sections.resize(static_cast<std::size_t>(count));
  std::uint64_t end = extent.begin, kind = 0;
  for (PacketSection& section : sections) {
    SectionEntry& entry = section.entry;
    const std::uint64_t gap = table_.code(coder, entry.offset - aligned(end), 1);
    if (gap > room) throw DamagedPacket("a section beyond its end");
    entry.offset = aligned(end) + gap;
    kind = table_.code(coder, entry.kind, 2 + static_cast<std::uint32_t>(kind == 11));
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(table_.code(coder, entry.a, 4));
    entry.b = static_cast<std::uint16_t>(table_.code(coder, entry.b, 5));
    entry.bytes = table_.code(coder, entry.bytes, 6);
    entry.reserved = static_cast<std::uint32_t>(table_.code(coder, entry.reserved, 7));
    if (entry.offset > extent.end || entry.bytes > extent.end - entry.offset) {
      throw DamagedPacket("a section beyond its end");
    }
    end = entry.offset + entry.bytes;
  }
  if (aligned(end) != extent.end) throw DamagedPacket("fewer bytes than it announces");
  for (PacketSection& section : sections) section.bytes.resize(static_cast<std::size_t>(section.entry.bytes));
}

void PacketModel::code_section(BitCoder& coder, std::uint32_t q, PacketSection& section) {
  const auto [kind, a, b] = std::tuple(static_cast<SectionKind>(section.entry.kind), section.entry.a, section.entry.b);
  const std::span bytes(section.bytes);
  const auto holds = [&](std::size_t record) { return bytes.size() % record == 0; };
  if (kind == SectionKind::refinement && a == q && holds(sizeof(layout::RefinementRecord))) {
    mesh_.code_refinement(coder, q, bytes);
  } else if (kind == SectionKind::nodes && a == q && holds(sizeof(layout::NodeRecord))) {
    mesh_.code_nodes(coder, q, bytes);
  } else if (kind == SectionKind::representatives && a <= q && b <= q && holds(sizeof(std::uint32_t))) {
    mesh_.code_representatives(coder, a, b, bytes);
  } else if (kind == SectionKind::scales && a <= 1 && b <= q && holds(sizeof(layout::Scale))) {
    mesh_.code_scales(coder, static_cast<layout::Role>(a), b, bytes);
  } else if (kind == SectionKind::base_triangles && holds(3 * sizeof(std::uint32_t))) {
    mesh_.code_words(coder, 3, bytes);
  } else {
    bytes_.code(coder, bytes);
  }
}

void PacketModel::code_couplings_of(BitCoder& coder, std::uint32_t q, std::uint32_t partner,
                                    std::span<PacketSection*> layers, const ModelView* model) {
  const auto columns = q == 0 ? mesh_.averages(0) : mesh_.details(q);
  const auto rows = partner == static_cast<std::uint32_t>(Partner::same)      ? columns
                    : partner == static_cast<std::uint32_t>(Partner::parents) ? mesh_.details(q == 0 ? 0 : q - 1)
                                                                              : mesh_.averages(q < 2 ? 0 : q - 2);
  CouplingBlocks known{.columns = static_cast<std::uint32_t>(columns.size()),
                       .rows = static_cast<std::uint32_t>(rows.size()),
                       .triangular = partner == static_cast<std::uint32_t>(Partner::same),
                       .dense = q == 0};
  std::vector<CouplingsData> data(layers.size());
  std::optional<CouplingBlocks> joined = known;
  if (model != nullptr) {
    for (std::size_t k = 0; k < layers.size(); ++k) {
      data[k] = read_couplings(model->level[q].couplings[partner][layers[k]->entry.b % layout::strengths]);
    }
    joined = join_layers(known, data);
    if (joined && (layers.size() > layout::strengths || !reproduces(*joined, data, layers, false))) joined.reset();
  }
  if (coder.code_plain(joined.has_value() ? 1 : 0, 1) == 0) {
    for (PacketSection* const section : layers) bytes_.code(coder, section->bytes);
    return;
  }
  if (layers.size() > layout::strengths) throw DamagedPacket("more layers of couplings than are joined");
  joined->bits.resize(layers.size());
  for (std::size_t k = 0; k < layers.size(); ++k) {
    CouplingsData& layer = data[k];
    layer.value_bits = static_cast<std::uint32_t>(coder.code_plain(layer.value_bits, 8));
    if (layer.value_bits < 2 || layer.value_bits > 16) throw DamagedPacket("couplings of no known width");
    layer.quantum = std::bit_cast<float>(
        static_cast<std::uint32_t>(coder.code_plain(std::bit_cast<std::uint32_t>(layer.quantum), 32)));
    joined->bits[k] = layer.value_bits;
  }
  code_couplings(coder, couplings_, *joined, columns, rows);
  if (model != nullptr) return;
  try {
    if (!reproduces(*joined, data, layers, true)) throw DamagedPacket("couplings of another length than announced");
  } catch (const std::invalid_argument& error) {
    throw DamagedPacket(error.what());
  }
}

}  // namespace greenloop::transport
