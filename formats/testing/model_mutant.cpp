#include "formats/testing/model_mutant.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "formats/write/describe.hpp"

namespace greenloop {

std::span<layout::SectionEntry> ModelMutant::table() {
  return {reinterpret_cast<layout::SectionEntry*>(bytes_.data() + sizeof(layout::Header)), header().section_count};
}

std::uint32_t ModelMutant::place(layout::SectionKind kind, std::uint32_t a, std::uint32_t b) {
  const auto entries = table();
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    if (entries[i].kind == static_cast<std::uint32_t>(kind) && entries[i].a == a && entries[i].b == b) return i;
  }
  throw std::out_of_range("the file has no section " + section_name(kind, a, b));
}

void ModelMutant::rebuild(const std::function<void(std::vector<SectionCopy>&)>& edit) {
  std::vector<SectionCopy> sections;
  for (const layout::SectionEntry& entry : table()) {
    const std::byte* data = bytes_.data() + entry.offset;
    sections.push_back({entry, {data, data + entry.bytes}});
  }
  edit(sections);

  std::size_t size = layout::aligned(sizeof(layout::Header) + sections.size() * sizeof(layout::SectionEntry));
  for (SectionCopy& section : sections) {
    section.entry.offset = size;
    section.entry.bytes = section.bytes.size();
    size = layout::aligned(size + section.bytes.size());
  }
  AlignedBytes file(size);
  std::memcpy(file.data(), bytes_.data(), sizeof(layout::Header));
  bytes_ = std::move(file);
  header().file_bytes = size;
  header().section_count = static_cast<std::uint32_t>(sections.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    table()[i] = sections[i].entry;
    std::copy(sections[i].bytes.begin(), sections[i].bytes.end(), bytes_.data() + sections[i].entry.offset);
  }
}

void ModelMutant::resize(std::size_t size) {
  AlignedBytes file(size);
  std::memcpy(file.data(), bytes_.data(), std::min(size, bytes_.size()));
  bytes_ = std::move(file);
  header().file_bytes = size;
}

VerifyResult ModelMutant::verdict() {
  reseal(bytes());
  return verify(bytes_.span(), view_);
}

}  // namespace greenloop
