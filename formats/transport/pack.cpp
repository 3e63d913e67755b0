#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "formats/transport/packet.hpp"
#include "formats/transport/stream.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"

namespace greenloop::transport {
namespace {

template <class Header>
void append_sealed(std::vector<std::byte>& stream, Header header) {
  const auto bytes = std::as_writable_bytes(std::span(&header, 1));
  header.header_crc = crc32c(bytes.first(offsetof(Header, header_crc)));
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}

// the sections of each level
std::vector<std::vector<PacketSection>> sections_by_level(std::span<const std::byte> model,
                                                          const layout::Header& header) {
  std::vector<std::vector<PacketSection>> levels(1);
  for (std::uint32_t i = 0; i < header.section_count; ++i) {
    PacketSection section;
    std::memcpy(&section.entry, model.data() + sizeof(header) + i * sizeof(section.entry), sizeof(section.entry));
    const auto bytes = model.subspan(section.entry.offset, section.entry.bytes);
    section.bytes.assign(bytes.begin(), bytes.end());
    const bool next = section.entry.kind == static_cast<std::uint32_t>(layout::SectionKind::level);
    if (next && section.entry.a > 0) levels.emplace_back();
    levels.back().push_back(std::move(section));
  }
  return levels;
}

std::uint64_t end_of(const PacketSection& section) {
  return (section.entry.offset + section.entry.bytes + layout::alignment - 1) / layout::alignment * layout::alignment;
}

}  // namespace

std::vector<std::byte> pack(std::span<const std::byte> model) {
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
  header.levels = static_cast<std::uint16_t>(view.levels);
  header.model_bytes = model.size();
  std::memcpy(header.model_reserved, view.header->reserved, sizeof(header.model_reserved));
  append_sealed(stream, header);

  PacketModel packets;
  auto levels = sections_by_level(file.span(), *view.header);
  FileExtent extent;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
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
