#include "formats/write/section_file.hpp"

#include <algorithm>
#include <cstring>

#include "formats/verify/crc32c.hpp"

namespace greenloop {
namespace {

// of the readers that know all of it, the oldest one's; files without newer kinds are of 4.1
std::uint16_t least_minor(const std::vector<SectionBytes>& sections) {
  std::uint16_t minor = 1;
  for (const SectionBytes& section : sections) {
    minor = std::max(minor, layout::first_minor(static_cast<layout::SectionKind>(section.entry.kind)));
  }
  return minor;
}

}  // namespace

void pad_to_alignment(std::vector<std::byte>& bytes) { bytes.resize(layout::aligned(bytes.size())); }

void seal(std::span<std::byte> file, layout::Header header) {
  std::memcpy(header.magic, layout::magic, sizeof(header.magic));
  header.endian = layout::endian_tag;
  header.file_bytes = file.size();
  header.table_crc = crc32c(file.subspan(sizeof(header), header.section_count * sizeof(layout::SectionEntry)));
  header.header_crc = crc32c(std::as_bytes(std::span(&header, 1)).first(offsetof(layout::Header, header_crc)));
  std::memcpy(file.data(), &header, sizeof(header));
}

std::vector<std::byte> file_of(std::vector<SectionBytes> sections, std::uint32_t levels, std::uint16_t minor) {
  layout::Header header{};
  header.major = layout::version_major;
  header.minor = std::max(minor, least_minor(sections));
  header.section_count = static_cast<std::uint32_t>(sections.size());
  header.levels = levels;

  std::vector<std::byte> file(sizeof(header) + sections.size() * sizeof(layout::SectionEntry));
  pad_to_alignment(file);
  std::size_t entry_at = sizeof(header);
  for (SectionBytes& section : sections) {
    section.entry.offset = file.size();
    section.entry.bytes = section.bytes.size();
    section.entry.crc = crc32c(section.bytes);
    std::memcpy(file.data() + entry_at, &section.entry, sizeof(section.entry));
    entry_at += sizeof(section.entry);
    file.insert(file.end(), section.bytes.begin(), section.bytes.end());
    pad_to_alignment(file);
    section.bytes = {};
  }
  seal(file, header);
  return file;
}

}  // namespace greenloop
