#include "formats/transport/packet.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "formats/transport/coupling_blocks.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop::transport {
namespace {

using layout::SectionEntry;
using layout::SectionKind;

constexpr std::uint32_t word_bytes = sizeof(std::uint32_t);

// How a kind is coded.
enum class Coding { bytes, words, refinement, predictions, nodes, representatives, scales, couplings };

Coding coding_of(const SectionEntry& entry) {
  switch (static_cast<SectionKind>(entry.kind)) {
#define GREENLOOP_ROW(kind, number, name, indices, element, coding)                                               \
  case SectionKind::kind:                                                                                         \
    static_assert(Coding::coding != Coding::words || layout::element_bytes(SectionKind::kind) % word_bytes == 0); \
    return Coding::coding;
    GREENLOOP_SECTION_KINDS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
  }
  return Coding::bytes;
}

// parents before positions before what needs positions
int rank(const SectionBytes& section) {
  switch (coding_of(section.entry)) {
    case Coding::bytes:
    case Coding::words:
    case Coding::refinement:
    case Coding::predictions:
      break;
    case Coding::nodes:
      return 1;
    case Coding::representatives:
    case Coding::scales:
      return 2;
    case Coding::couplings:
      return 3;
  }
  return 0;
}

std::vector<std::byte> layer_bytes(const CouplingBlocks& joined, std::uint32_t layer) {
  return encode_couplings(take_layer(joined, layer),
                          {joined.components, joined.columns, joined.rows, layout::value_bits[layer]}, "couplings");
}

// of a model with this Info; a decoder's may say anything
std::uint32_t stated_components(std::span<const std::byte> info) {
  layout::InfoStart start{};
  if (info.size() >= sizeof(start)) std::memcpy(&start, info.data(), sizeof(start));
  return layout::components_of(static_cast<layout::Problem>(start.problem));
}

// whether the sections are what the writer makes of the blocks
bool are_reproduced(const CouplingBlocks& joined, std::span<SectionBytes*> layers) {
  if (layers.size() != layout::layers) return false;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    if (layers[layer]->entry.b != layer || layer_bytes(joined, layer) != layers[layer]->bytes) return false;
  }
  return true;
}

}  // namespace

std::uint32_t content_crc(std::span<const SectionBytes> sections) {
  std::uint32_t crc = 0;
  for (const SectionBytes& section : sections) crc = crc32c(std::as_bytes(std::span(&section.entry, 1)), crc);
  for (const SectionBytes& section : sections) crc = crc32c(section.bytes, crc);
  return crc;
}

namespace {

// A model has every section once, and those that are known are of a level: their models are made for each, and some
// look at all nodes.
void require_distinct(const std::vector<SectionBytes>& sections) {
  std::set<std::tuple<std::uint32_t, std::uint16_t, std::uint16_t>> seen;
  for (const SectionBytes& section : sections) {
    const SectionEntry& entry = section.entry;
    if (!layout::is_section_kind(entry.kind)) continue;
    if (entry.a >= layout::max_levels || entry.b >= layout::max_levels) throw DamagedPacket("a section of no level");
    if (!seen.emplace(entry.kind, entry.a, entry.b).second) throw DamagedPacket("a section that stands twice");
  }
}

}  // namespace

void PacketModel::code(BitCoder& coder, std::uint32_t q, FileExtent extent, std::vector<SectionBytes>& sections,
                       const ModelView* model) {
  code_table(coder, extent, sections);
  require_distinct(sections);
  std::vector<SectionBytes*> order;
  order.reserve(sections.size());
  for (SectionBytes& section : sections) order.push_back(&section);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return rank(*a) < rank(*b); });

  std::vector<SectionBytes*> couplings;
  for (SectionBytes* const section : order) {
    if (coding_of(section->entry) == Coding::couplings && section->entry.a == q) {
      couplings.push_back(section);
    } else if (!code_records(coder, q, *section)) {
      bytes_.code(coder, section->bytes);
    }
    if (section->entry.kind == static_cast<std::uint32_t>(SectionKind::info)) {
      components_ = stated_components(section->bytes);
    }
  }
  if (!couplings.empty()) code_couplings(coder, q, couplings, model);
  for (SectionBytes& section : sections) section.entry.crc = crc32c(section.bytes);
}

void PacketModel::code_table(BitCoder& coder, FileExtent extent, std::vector<SectionBytes>& sections) {
  const std::uint64_t room = extent.end - extent.begin;
  const std::uint64_t count = table_.code(coder, sections.size(), 0);
  if (count > room / sizeof(SectionEntry)) throw DamagedPacket("more sections than fit in it");
  sections.resize(static_cast<std::size_t>(count));
  std::uint64_t end = extent.begin;
  bool after_couplings = false;
  for (SectionBytes& section : sections) {
    SectionEntry& entry = section.entry;
    const std::uint64_t gap = table_.code(coder, entry.offset - layout::aligned(end), 1);
    if (gap > room) throw DamagedPacket("a section beyond its end");
    entry.offset = layout::aligned(end) + gap;
    entry.kind = static_cast<std::uint32_t>(table_.code(coder, entry.kind, after_couplings ? 3 : 2));
    after_couplings = coding_of(entry) == Coding::couplings;
    entry.a = static_cast<std::uint16_t>(table_.code(coder, entry.a, 4));
    entry.b = static_cast<std::uint16_t>(table_.code(coder, entry.b, 5));
    entry.bytes = table_.code(coder, entry.bytes, 6);
    entry.reserved = static_cast<std::uint32_t>(table_.code(coder, entry.reserved, 7));
    if (entry.offset > extent.end || entry.bytes > extent.end - entry.offset) {
      throw DamagedPacket("a section beyond its end");
    }
    end = entry.offset + entry.bytes;
  }
  if (layout::aligned(end) != extent.end) throw DamagedPacket("fewer bytes than it announces");
  for (SectionBytes& section : sections) section.bytes.resize(static_cast<std::size_t>(section.entry.bytes));
}

bool PacketModel::code_records(BitCoder& coder, std::uint32_t q, SectionBytes& section) {
  const auto [a, b] = std::pair(section.entry.a, section.entry.b);
  const std::uint32_t element = layout::element_bytes(static_cast<SectionKind>(section.entry.kind));
  const std::span bytes(section.bytes);
  if (element == 0 || bytes.size() % element != 0) return false;
  switch (coding_of(section.entry)) {
    case Coding::bytes:
    case Coding::couplings:
      return false;
    case Coding::words:
      mesh_.code_words(coder, element / word_bytes, bytes);
      return true;
    case Coding::refinement:
      if (a == q) mesh_.code_refinement(coder, q, bytes);
      return a == q;
    case Coding::predictions:
      if (a == q) code_predictions(coder, bytes);
      return a == q;
    case Coding::nodes:
      if (a == q) mesh_.code_nodes(coder, q, bytes);
      return a == q;
    case Coding::representatives:
      if (a <= q && b <= q) mesh_.code_representatives(coder, a, b, bytes);
      return a <= q && b <= q;
    case Coding::scales:
      if (a == q) mesh_.code_scales(coder, q, components_, bytes);
      return a == q;
  }
  return false;
}

void PacketModel::code_predictions(BitCoder& coder, std::span<std::byte> bytes) {
  const std::size_t header = std::min(bytes.size(), sizeof(layout::PredictionsHeader));
  bytes_.code(coder, bytes.first(header));
  if (!PredictionsModel::fits(bytes, components_)) return bytes_.code(coder, bytes.subspan(header));
  predictions_.code(coder, bytes, components_);
  const auto [between, behind] = gaps_of_predictions(bytes, components_);
  bytes_.code(coder, between);
  bytes_.code(coder, behind);
}

void PacketModel::code_couplings(BitCoder& coder, std::uint32_t q, std::span<SectionBytes*> layers,
                                 const ModelView* model) {
  const std::vector<Coefficient> coefficients = mesh_.coefficients(q);
  const std::uint32_t columns = mesh_.own_coefficients(q);
  const auto rows = static_cast<std::uint32_t>(coefficients.size());
  std::optional<CouplingBlocks> joined = CouplingBlocks{.components = components_, .columns = columns, .rows = rows};
  if (model != nullptr) {
    joined = join_layers(model->level[q], components_, columns, rows);
    if (joined && !are_reproduced(*joined, layers)) joined.reset();
  }
  if (coder.code_plain(joined.has_value() ? 1 : 0, 1) == 0) {
    for (SectionBytes* const section : layers) bytes_.code(coder, section->bytes);
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
