#include "formats/transport/packet.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "formats/transport/coupling_blocks.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/verify/section_extent.hpp"

namespace greenloop::transport {
namespace {

using layout::SectionEntry;
using layout::SectionKind;

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

std::vector<std::byte> layer_bytes(const CouplingBlocks& joined, std::uint32_t layer) {
  return encode_couplings(take_layer(joined, layer), joined.columns, joined.rows, layout::value_bits[layer],
                          "couplings");
}

// whether the sections are what the writer makes of the blocks
bool are_reproduced(const CouplingBlocks& joined, std::span<PacketSection*> layers) {
  if (layers.size() != layout::layers) return false;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    if (layers[layer]->entry.b != layer || layer_bytes(joined, layer) != layers[layer]->bytes) return false;
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

  std::vector<PacketSection*> couplings;
  for (PacketSection* const section : order) {
    if (is(*section, SectionKind::couplings) && section->entry.a == q) {
      couplings.push_back(section);
    } else {
      code_section(coder, q, *section);
    }
  }
  if (!couplings.empty()) code_couplings(coder, q, couplings, model);
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
  } else if (kind == SectionKind::stencils && holds(sizeof(layout::StencilRecord))) {
    mesh_.code_words(coder, sizeof(layout::StencilRecord) / sizeof(std::uint32_t), bytes);
  } else if (kind == SectionKind::predictions && a == q) {
    code_predictions(coder, bytes);
  } else if (kind == SectionKind::nodes && a == q && holds(sizeof(layout::NodeRecord))) {
    mesh_.code_nodes(coder, q, bytes);
  } else if (kind == SectionKind::representatives && a <= q && b <= q && holds(sizeof(std::uint32_t))) {
    mesh_.code_representatives(coder, a, b, bytes);
  } else if (kind == SectionKind::scales && a == q && holds(sizeof(layout::Scale))) {
    mesh_.code_scales(coder, q, bytes);
  } else if (kind == SectionKind::patterns && holds(sizeof(layout::PatternRecord))) {
    mesh_.code_words(coder, sizeof(layout::PatternRecord) / sizeof(std::uint32_t), bytes);
  } else if (kind == SectionKind::base_triangles && holds(3 * sizeof(std::uint32_t))) {
    mesh_.code_words(coder, 3, bytes);
  } else {
    bytes_.code(coder, bytes);
  }
}

void PacketModel::code_predictions(BitCoder& coder, std::span<std::byte> bytes) {
  const std::size_t header = std::min(bytes.size(), sizeof(layout::PredictionsHeader));
  bytes_.code(coder, bytes.first(header));
  if (!PredictionsModel::fits(bytes)) return bytes_.code(coder, bytes.subspan(header));
  predictions_.code(coder, bytes);
  const auto [between, behind] = gaps_of_predictions(bytes);
  bytes_.code(coder, between);
  bytes_.code(coder, behind);
}

void PacketModel::code_couplings(BitCoder& coder, std::uint32_t q, std::span<PacketSection*> layers,
                                 const ModelView* model) {
  const std::vector<Coefficient> coefficients = mesh_.coefficients(q);
  const std::uint32_t columns = mesh_.own_coefficients(q);
  const auto rows = static_cast<std::uint32_t>(coefficients.size());
  std::optional<CouplingBlocks> joined = CouplingBlocks{.columns = columns, .rows = rows};
  if (model != nullptr) {
    joined = join_layers(model->level[q], columns, rows);
    if (joined && !are_reproduced(*joined, layers)) joined.reset();
  }
  if (coder.code_plain(joined.has_value() ? 1 : 0, 1) == 0) {
    for (PacketSection* const section : layers) bytes_.code(coder, section->bytes);
    return;
  }
  if (layers.size() != layout::layers) throw DamagedPacket("more or fewer layers of couplings than there are");
  couplings_.code(coder, *joined, coefficients);
  if (model != nullptr) return;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    auto bytes = layer_bytes(*joined, layer);
    if (bytes.size() != layers[layer]->bytes.size()) {
      throw DamagedPacket("couplings of another length than announced");
    }
    layers[layer]->bytes = std::move(bytes);
  }
}

}  // namespace greenloop::transport
