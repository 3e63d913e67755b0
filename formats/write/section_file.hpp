#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/layout.hpp"

namespace greenloop {

/// A section of a model file, whatever its kind.
struct SectionBytes {
  layout::SectionEntry entry{};
  std::vector<std::byte> bytes;
};

/// Adds zeros up to the next multiple of layout::alignment.
void pad_to_alignment(std::vector<std::byte>& bytes);

/// The file of these sections, in this order: header (of the least minor version that has their kinds, and `minor`,
/// that of what they hold, at least), table and padding are made, offsets, lengths and checksums filled in. Offline
/// only.
[[nodiscard]] std::vector<std::byte> file_of(std::vector<SectionBytes> sections, std::uint32_t levels,
                                             std::uint16_t minor);

/// Writes the header in front of a file whose sections and table stand. Taken from `header`: major and minor version,
/// section_count, levels and what is reserved; the rest is filled in. Offline only.
void seal(std::span<std::byte> file, layout::Header header);

}  // namespace greenloop
