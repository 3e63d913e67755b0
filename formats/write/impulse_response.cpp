#include "formats/write/impulse_response.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "formats/layout/impulse_response_order.hpp"
#include "formats/verify.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/section_file.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;
using Bytes = std::vector<std::byte>;

void require(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("impulse response model to be written: " + what);
}

void require_size(const std::string& what, std::size_t size, std::size_t expected) {
  require(size == expected, fmt::format("{} has {} entries, expected {}", what, size, expected));
}

template <class Record>
Bytes bytes_of(std::span<const Record> records) {
  const auto bytes = std::as_bytes(records);
  return {bytes.begin(), bytes.end()};
}

template <class Record>
Bytes bytes_of(const std::vector<Record>& records) {
  return bytes_of(std::span(records));
}

// A value as its planes: the sum of 256 times the first and the second, or the first alone.
std::int8_t plane_of(std::int32_t value, std::uint32_t plane, std::uint32_t planes) {
  if (planes == 1) return static_cast<std::int8_t>(value);
  const std::int32_t low = ((value + 128) & 255) - 128;
  return static_cast<std::int8_t>(plane == 0 ? (value - low) / 256 : low);
}

// The sections of a model in the order of layout/impulse_response_order.hpp.
class SectionList {
 public:
  explicit SectionList(const ImpulseResponseData& model) : model_(model), info_(completed_info()) {
    add(SectionKind::info, 0, 0, bytes_of(std::vector{info_}));
    add(SectionKind::provenance, 0, 0, bytes_of(std::vector<char>(model.provenance.begin(), model.provenance.end())));
    for (std::uint32_t q = 0; q < info_.levels; ++q) {
      check_group(q);
      layout::visit_impulse_response_level(info_, q, [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
        add(kind, a, b, section_bytes(kind, a, b));
        return true;
      });
    }
    layout::visit_appearance(info_, [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
      add(kind, a, b, section_bytes(kind, a, b));
      return true;
    });
  }

  [[nodiscard]] std::vector<SectionBytes> take() && { return std::move(sections_); }

 private:
  [[nodiscard]] static std::uint32_t count(std::size_t size) { return static_cast<std::uint32_t>(size); }
  [[nodiscard]] std::uint32_t modes(std::uint32_t q) const { return count(model_.groups[q].amplitudes.size()); }

  [[nodiscard]] layout::ImpulseInfo completed_info() const {
    layout::ImpulseInfo info = model_.info;
    info.problem = static_cast<std::uint32_t>(layout::Problem::impulse_response);
    info.components = 3;
    info.levels = count(model_.groups.size());
    info.modes = 0;
    for (std::uint32_t q = 0; q < info.levels; ++q) info.modes += modes(q);
    info.vertices = count(model_.shape.size() / 3);
    info.triangles = count(model_.triangles.size() / 3);
    info.impulses = count(model_.impulses.size());
    info.orbits = count(model_.orbits.size());
    info.rows = model_.orbits.empty() ? 0 : model_.orbits.back().first_row + model_.orbits.back().rows;
    require(info.planes == 1 || info.planes == 2, fmt::format("info.planes is {}, expected 1 or 2", info.planes));
    require_size("shape", model_.shape.size(), std::size_t{3} * info.vertices);
    require_size("triangles", model_.triangles.size(), std::size_t{3} * info.triangles);
    require_size("successions", model_.successions.size(), std::size_t{info.impulses + 1} * info.impulses);
    complete_appearance(info);
    require_size("references", model_.references.size(), std::size_t{info.rows} * info.impulses);
    return info;
  }

  void complete_appearance(layout::ImpulseInfo& info) const {
    const AppearanceData& appearance = model_.appearance;
    const std::size_t blocks = (info.vertices + layout::block_vertices - 1) / layout::block_vertices;
    info.transfer_modes = count(appearance.amplitudes.size());
    info.transfer_states = appearance.states;
    info.transfer_error = appearance.error;
    info.transfer_quantisation_error = appearance.quantisation_error;
    const std::size_t any = info.transfer_modes > 0 ? 1 : 0;
    require_size("appearance.quanta", appearance.quanta.size(), any * 2 * blocks);
    require_size("appearance.transfers", appearance.transfers.size(),
                 any * layout::colours * blocks * layout::transfer_bytes(info.transfer_modes));
    require_size("appearance.coordinates", appearance.coordinates.size(), std::size_t{info.rows} * info.transfer_modes);
  }

  void check_group(std::uint32_t q) const {
    const ModeGroupData& group = model_.groups[q];
    require(modes(q) > 0 && modes(q) % 2 == 0,
            fmt::format("groups[{}] has {} modes, expected an even number", q, modes(q)));
    require_size(fmt::format("groups[{}].values", q), group.values.size(), std::size_t{3} * info_.vertices * modes(q));
    require_size(fmt::format("groups[{}].coordinates", q), group.coordinates.size(),
                 std::size_t{info_.rows} * modes(q));
  }

  [[nodiscard]] layout::ImpulseLevel completed_counts(std::uint32_t q) const {
    layout::ImpulseLevel counts = model_.groups[q].counts;
    counts.modes = modes(q);
    counts.mode_end = 0;
    for (std::uint32_t r = 0; r <= q; ++r) counts.mode_end += modes(r);
    return counts;
  }

  [[nodiscard]] Bytes modes_bytes(std::uint32_t q, std::uint32_t plane) const {
    constexpr std::size_t values = layout::block_values;
    const std::size_t blocks = (info_.vertices + layout::block_vertices - 1) / layout::block_vertices;
    const std::size_t modes_of_group = modes(q);
    const std::int32_t most = layout::most_value(info_.planes);
    Bytes bytes(blocks * values * modes_of_group);
    for (std::size_t v = 0; v < std::size_t{3} * info_.vertices; ++v) {
      for (std::size_t m = 0; m < modes_of_group; ++m) {
        const std::int32_t value = model_.groups[q].values[v * modes_of_group + m];
        require(value >= -most && value <= most,
                fmt::format("groups[{}].values[{}] = {} is beyond {}", q, v * modes_of_group + m, value, most));
        const std::size_t pair = (v / values) * (modes_of_group / 2) + m / 2;
        bytes[2 * (pair * values + v % values) + m % 2] = static_cast<std::byte>(plane_of(value, plane, info_.planes));
      }
    }
    return bytes;
  }

  [[nodiscard]] Bytes section_bytes(SectionKind kind, std::uint32_t a, std::uint32_t b) const {
    switch (kind) {
      case SectionKind::level:
        return bytes_of(std::vector{completed_counts(a)});
      case SectionKind::shape:
        return bytes_of(model_.shape);
      case SectionKind::triangles:
        return bytes_of(model_.triangles);
      case SectionKind::quanta:
        return bytes_of(model_.quanta);
      case SectionKind::impulses:
        return bytes_of(model_.impulses);
      case SectionKind::successions:
        return bytes_of(model_.successions);
      case SectionKind::orbits:
        return bytes_of(model_.orbits);
      case SectionKind::references:
        return bytes_of(model_.references);
      case SectionKind::modes:
        return modes_bytes(a, b);
      case SectionKind::amplitudes:
        return bytes_of(model_.groups[a].amplitudes);
      case SectionKind::coordinates:
        return bytes_of(model_.groups[a].coordinates);
      case SectionKind::transfer_quanta:
        return bytes_of(model_.appearance.quanta);
      case SectionKind::transfers:
        return bytes_of(model_.appearance.transfers);
      case SectionKind::transfer_amplitudes:
        return bytes_of(model_.appearance.amplitudes);
      case SectionKind::transfer_coordinates:
        return bytes_of(model_.appearance.coordinates);
      default:
        return {};  // no other kind is in the order
    }
  }

  void add(SectionKind kind, std::uint32_t a, std::uint32_t b, Bytes bytes) {
    layout::SectionEntry entry{};
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(a);
    entry.b = static_cast<std::uint16_t>(b);
    sections_.push_back({entry, std::move(bytes)});
  }

  const ImpulseResponseData& model_;
  layout::ImpulseInfo info_;
  std::vector<SectionBytes> sections_;
};

}  // namespace

ModelFile encoded_file(const ImpulseResponseData& model) {
  require(!model.groups.empty() && model.groups.size() <= layout::max_levels,
          fmt::format("{} groups of modes, expected 1 to {}", model.groups.size(), layout::max_levels));
  ModelFile file{AlignedBytes(file_of(SectionList(model).take(), static_cast<std::uint32_t>(model.groups.size()), 0)),
                 {}};
  const VerifyResult result = verify(file.bytes.span(), file.view);
  require(result.ok(), describe(result));
  return file;
}

std::vector<std::byte> encode(const ImpulseResponseData& model) {
  const ModelFile file = encoded_file(model);
  const auto bytes = file.bytes.span();
  return {bytes.begin(), bytes.end()};
}

}  // namespace greenloop
