#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "formats/transport/packet.hpp"
#include "formats/transport/stream.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/ready_file.hpp"

namespace greenloop::transport {
namespace {

template <class Header>
void append_sealed(std::vector<std::byte>& stream, Header header) {
  const auto bytes = std::as_writable_bytes(std::span(&header, 1));
  header.header_crc = crc32c(bytes.first(offsetof(Header, header_crc)));
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}

// the sections of each level
std::vector<std::vector<SectionBytes>> sections_by_level(std::span<const std::byte> model, const FileView& view) {
  std::vector<std::vector<SectionBytes>> levels(1);
  for (const layout::SectionEntry& entry : section_entries(view)) {
    const auto bytes = model.subspan(entry.offset, entry.bytes);
    const bool next = entry.kind == static_cast<std::uint32_t>(layout::SectionKind::level);
    if (next && entry.a > 0) levels.emplace_back();
    levels.back().push_back({entry, {bytes.begin(), bytes.end()}});
  }
  return levels;
}

std::uint64_t end_of(const SectionBytes& section) {
  return layout::aligned(section.entry.offset + section.entry.bytes);
}

}  // namespace

std::vector<std::byte> pack(std::span<const std::byte> whole) {
  const std::vector<std::byte> model = plain_file(whole);
  const AlignedBytes file(model);
  ModelView view;
  const VerifyResult result = verify(file.span(), view);
  if (!result.ok()) throw std::invalid_argument("model to be packed: " + describe(result));

  std::vector<std::byte> stream;
  StreamHeader header{};
  std::memcpy(header.magic, magic, sizeof(magic));
  header.major = version_major;
  header.model_major = view.header->major;
  header.model_minor = view.header->minor;
  header.levels = static_cast<std::uint16_t>(view.header->levels);
  header.model_bytes = model.size();
  std::memcpy(header.model_reserved, view.header->reserved, sizeof(header.model_reserved));
  append_sealed(stream, header);

  PacketModel packets;
  auto levels = sections_by_level(file.span(), view);
  FileExtent extent;
  for (std::uint32_t q = 0; q < view.header->levels; ++q) {
    extent.end = end_of(levels[q].back());
    RangeEncoder encoder;
    packets.code(encoder, q, extent, levels[q], &view);
    const auto least = static_cast<std::size_t>((extent.end - extent.begin) / most_expansion + 1);
    const std::vector<std::byte> coded = encoder.finish(least);
    append_sealed(stream, PacketHeader{.level = q,
                                       .coded_crc = crc32c(coded),
                                       .coded_bytes = coded.size(),
                                       .content_bytes = extent.end - extent.begin,
                                       .content_crc = content_crc(levels[q]),
                                       .header_crc = 0});
    stream.insert(stream.end(), coded.begin(), coded.end());
    extent.begin = extent.end;
    levels[q] = {};
  }
  return stream;
}

}  // namespace greenloop::transport
