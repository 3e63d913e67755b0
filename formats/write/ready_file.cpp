#include "formats/write/ready_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/layout/elastostatic_order.hpp"
#include "formats/ready/base_columns.hpp"
#include "formats/ready/mirrored_couplings.hpp"
#include "formats/stored_blocks.hpp"
#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/section_file.hpp"
#include "formats/write/writer.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;
using Bytes = std::vector<std::byte>;

ModelView require_valid(const AlignedBytes& file, const std::string& what) {
  ModelView view;
  const VerifyResult result = verify(file.span(), view);
  if (!result.ok()) throw std::invalid_argument(what + ": " + describe(result));
  return view;
}

std::vector<SectionBytes> plain_sections(const AlignedBytes& file, const ModelView& view) {
  std::vector<SectionBytes> sections;
  for (const layout::SectionEntry& entry : section_entries(view)) {
    if (layout::is_ready_kind(static_cast<SectionKind>(entry.kind))) continue;
    const auto bytes = file.span().subspan(entry.offset, entry.bytes);
    sections.push_back({entry, {bytes.begin(), bytes.end()}});
  }
  return sections;
}

// of what the sections of the levels hold
std::uint16_t least_minor(const ModelView& view) {
  std::uint16_t minor = layout::first_minor(*view.info);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    if (view.level[q].counts->cut_error != 0) minor = std::max(minor, layout::first_minor_of_cuts);
  }
  return minor;
}

template <unsigned N>
Bytes base_columns_bytes(const ModelView& view, const BaseColumns& base) {
  layout::BaseColumnsHeader header{};
  header.columns = base.columns;
  header.tiles = base.tiles;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    header.layer_mask |= base.holds[layer] ? 1U << layer : 0U;
  }
  Bytes bytes(sizeof(header) + static_cast<std::size_t>(value_bytes<N>(base)));
  std::memcpy(bytes.data(), &header, sizeof(header));
  fill_base_columns<N>(view, base, bytes.data() + sizeof(header));
  return bytes;
}

template <unsigned N>
CouplingsData mirrored_couplings(const ModelView& view, std::uint32_t layer, const BaseColumns& base,
                                 const std::uint8_t* read) {
  CouplingsData data;
  data.begin.resize(view.domain_count + std::size_t{1});
  visit_mirrored(view, layer, base, read, [&](const CouplingsView&, std::uint32_t row, std::uint32_t, std::uint32_t) {
    ++data.begin[row + std::size_t{1}];
  });
  for (std::size_t i = 0; i < view.domain_count; ++i) data.begin[i + 1] += data.begin[i];
  data.index.resize(data.begin.back());
  data.value.resize(std::size_t{N} * N * data.begin.back());
  std::vector<std::uint32_t> next = data.begin;
  visit_mirrored(view, layer, base, read,
                 [&](const CouplingsView& from, std::uint32_t row, std::uint32_t column, std::uint32_t position) {
                   const std::size_t at = next[row]++;
                   data.index[at] = column;
                   for (std::uint32_t k = 0; k < N * N; ++k) {  // transposed
                     data.value[std::size_t{N} * N * at + std::size_t{N} * (k % N) + k / N] =
                         stored_value<N>(from, layout::value_bits[layer], position, k);
                   }
                 });
  return data;
}

template <unsigned N>
void add_ready_sections(const ModelView& view, std::span<const std::uint8_t> read,
                        std::vector<SectionBytes>& sections) {
  const BaseColumns base = base_columns_of(view);
  const auto bytes_of = [&](SectionKind kind, std::uint32_t a) -> Bytes {
    if (kind == SectionKind::base_columns) return base_columns_bytes<N>(view, base);
    if (kind == SectionKind::mirrored_couplings) {
      return encode_couplings(mirrored_couplings<N>(view, a, base, read.data()),
                              {N, view.domain_count, view.domain_count, layout::value_bits[a]},
                              section_name(kind, a, 0));
    }
    const auto marks = std::as_bytes(read);
    return {marks.begin(), marks.end()};
  };
  layout::visit_ready_sections([&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
    layout::SectionEntry entry{};
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(a);
    entry.b = static_cast<std::uint16_t>(b);
    sections.push_back({entry, bytes_of(kind, a)});
    return true;
  });
}

}  // namespace

std::vector<std::byte> ready_file(std::span<const std::byte> model, std::span<const std::uint8_t> read) {
  const AlignedBytes file(model);
  const ModelView view = require_valid(file, "model to be made ready");
  if (read.size() != view.domain_count) {
    throw std::invalid_argument(fmt::format(
        "model to be made ready: {} marks of coefficients that are read, expected {}", read.size(), view.domain_count));
  }
  std::vector<SectionBytes> sections = plain_sections(file, view);
  if (view.info->components == 1) {
    add_ready_sections<1>(view, read, sections);
  } else {
    add_ready_sections<3>(view, read, sections);
  }
  Bytes ready = file_of(std::move(sections), view.levels, least_minor(view));
  require_valid(AlignedBytes(ready), "model made ready");
  return ready;
}

std::vector<std::byte> plain_file(std::span<const std::byte> model) {
  const AlignedBytes file(model);
  const ModelView view = require_valid(file, "model");
  if (view.ready.read == nullptr) return {model.begin(), model.end()};
  return file_of(plain_sections(file, view), view.levels, least_minor(view));
}

}  // namespace greenloop
