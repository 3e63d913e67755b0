#pragma once

#include <span>

#include "formats/layout/header.hpp"

namespace greenloop {

/// What every model file shows, whatever its problem, in place.
struct FileView {
  const layout::Header* header = nullptr;
  layout::Problem problem = {};
  std::span<const char> provenance;
};

/// The section table of a verified file, in file order.
inline std::span<const layout::SectionEntry> section_entries(const FileView& view) {
  return {reinterpret_cast<const layout::SectionEntry*>(view.header + 1), view.header->section_count};
}

}  // namespace greenloop
