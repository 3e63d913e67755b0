#include "formats/testing/reseal.hpp"

#include <algorithm>
#include <cstddef>

#include "formats/layout.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop {

void reseal(std::span<std::byte> file) {
  if (file.size() < sizeof(layout::Header)) return;
  auto& header = *reinterpret_cast<layout::Header*>(file.data());
  auto* entries = reinterpret_cast<layout::SectionEntry*>(file.data() + sizeof(header));
  const std::size_t room = (file.size() - sizeof(header)) / sizeof(layout::SectionEntry);
  const std::span table(entries, std::min<std::size_t>(header.section_count, room));
  for (layout::SectionEntry& entry : table) {
    if (entry.offset > file.size() || entry.bytes > file.size() - entry.offset) continue;
    entry.crc = crc32c(file.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.bytes)));
  }
  header.table_crc = crc32c(std::as_bytes(table));
  header.header_crc = crc32c(file.first(offsetof(layout::Header, header_crc)));
}

}  // namespace greenloop
