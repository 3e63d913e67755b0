#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "formats/transport/packet.hpp"
#include "formats/transport/stream.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"

namespace greenloop::transport {
namespace {

// Reads the packets of a stream one after the other.
class StreamReader {
 public:
  StreamReader(std::span<const std::byte> stream, StreamResult& result) : stream_(stream), result_(result) {}

  bool read_header();
  bool read_packet();
  bool finish();

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  [[nodiscard]] std::uint32_t packets() const { return packet_; }

  /// The model of the packets read so far.
  [[nodiscard]] std::vector<std::byte> model() const;

 private:
  bool refuse(StreamRule rule, std::uint64_t offset, const char* field, std::uint64_t value, std::uint64_t limit,
              std::string reason = {}) {
    result_ = {rule, packet_, offset, field, value, limit, std::move(reason)};
    return false;
  }
  bool require(bool right, StreamRule rule, std::uint64_t offset, const char* field, std::uint64_t value,
               std::uint64_t limit) {
    return right || refuse(rule, offset, field, value, limit);
  }
  [[nodiscard]] std::uint64_t left() const { return stream_.size() - next_; }

  template <class Header>
  bool take(Header& header);
  bool check_extent(const PacketHeader& packet, std::uint64_t at);
  bool decode(const PacketHeader& packet, std::span<const std::byte> coded);

  std::span<const std::byte> stream_;
  StreamResult& result_;
  StreamHeader header_{};
  std::size_t next_ = 0;              // byte of the stream
  std::uint32_t packet_ = 0;          // number of those read
  std::uint64_t end_ = 0;             // of the model file so far
  std::optional<PacketModel> model_;  // made when there is something to decode
  std::vector<SectionBytes> sections_;
};

template <class Header>
bool StreamReader::take(Header& header) {
  if (!require(left() >= sizeof(header), StreamRule::truncated, next_, "header", left(), sizeof(header))) return false;
  std::memcpy(&header, stream_.data() + next_, sizeof(header));
  const std::size_t at = offsetof(Header, header_crc);
  const std::uint32_t crc = crc32c(stream_.subspan(next_, at));
  if (!require(header.header_crc == crc, StreamRule::header_checksum, next_ + at, "header_crc", header.header_crc,
               crc)) {
    return false;
  }
  next_ += sizeof(header);
  return true;
}

bool StreamReader::read_header() {
  const auto seen = std::as_bytes(std::span(magic)).first(std::min(stream_.size(), sizeof(magic)));
  if (!std::equal(seen.begin(), seen.end(), stream_.begin())) return refuse(StreamRule::bad_magic, 0, "magic", 0, 0);
  return take(header_) &&
         require(header_.major == version_major, StreamRule::unsupported_version, offsetof(StreamHeader, major),
                 "major", header_.major, version_major) &&
         require(header_.model_major == layout::version_major, StreamRule::unsupported_version,
                 offsetof(StreamHeader, model_major), "model_major", header_.model_major, layout::version_major) &&
         require(header_.levels >= 1 && header_.levels <= layout::max_levels, StreamRule::out_of_range,
                 offsetof(StreamHeader, levels), "levels", header_.levels, layout::max_levels);
}

bool StreamReader::read_packet() {
  const std::size_t at = next_;
  PacketHeader packet{};
  if (!take(packet) || !check_extent(packet, at)) return false;
  if (!require(packet.coded_bytes <= left(), StreamRule::truncated, next_, "coded_bytes", left(), packet.coded_bytes)) {
    return false;
  }
  const auto coded = stream_.subspan(next_, static_cast<std::size_t>(packet.coded_bytes));
  const std::uint32_t crc = crc32c(coded);
  if (!require(packet.coded_crc == crc, StreamRule::packet_checksum, next_, "coded_crc", packet.coded_crc, crc) ||
      !decode(packet, coded)) {
    return false;
  }
  next_ += coded.size();
  end_ += packet.content_bytes;
  ++packet_;
  return true;
}

bool StreamReader::check_extent(const PacketHeader& packet, std::uint64_t at) {
  const std::uint64_t most = header_.model_bytes - end_;
  return require(packet.level == packet_, StreamRule::out_of_range, at, "level", packet.level, packet_) &&
         require(packet.content_bytes <= most && packet.content_bytes % layout::alignment == 0,
                 StreamRule::out_of_range, at + offsetof(PacketHeader, content_bytes), "content_bytes",
                 packet.content_bytes, most) &&
         require(packet.content_bytes / most_expansion <= packet.coded_bytes, StreamRule::out_of_range,
                 at + offsetof(PacketHeader, coded_bytes), "coded_bytes", packet.coded_bytes,
                 packet.content_bytes / most_expansion);
}

bool StreamReader::decode(const PacketHeader& packet, std::span<const std::byte> coded) {
  std::vector<SectionBytes> sections;
  try {
    RangeDecoder decoder(coded);
    if (!model_) model_.emplace();
    model_->code(decoder, packet_, {end_, end_ + packet.content_bytes}, sections, nullptr);
  } catch (const DamagedPacket& damage) {
    return refuse(StreamRule::damaged, next_, "coded bytes", 0, 0, damage.what());
  }
  const std::uint32_t crc = content_crc(sections);
  if (!require(packet.content_crc == crc, StreamRule::content_checksum, next_, "content_crc", packet.content_crc,
               crc)) {
    return false;
  }
  std::move(sections.begin(), sections.end(), std::back_inserter(sections_));
  const std::uint64_t table_end = sizeof(layout::Header) + sections_.size() * sizeof(layout::SectionEntry);
  return require(!sections_.empty() && table_end <= sections_.front().entry.offset, StreamRule::out_of_range, next_,
                 "section table", table_end, sections_.empty() ? 0 : sections_.front().entry.offset);
}

bool StreamReader::finish() {
  return require(end_ == header_.model_bytes, StreamRule::out_of_range, offsetof(StreamHeader, model_bytes),
                 "model_bytes", header_.model_bytes, end_) &&
         require(left() == 0, StreamRule::trailing_bytes, next_, "bytes after the last packet", left(), 0);
}

std::vector<std::byte> StreamReader::model() const {
  std::vector<std::byte> file(static_cast<std::size_t>(end_));
  std::byte* entry = file.data() + sizeof(layout::Header);
  for (const SectionBytes& section : sections_) {
    std::memcpy(entry, &section.entry, sizeof(section.entry));
    entry += sizeof(section.entry);
    std::copy(section.bytes.begin(), section.bytes.end(),
              file.begin() + static_cast<std::ptrdiff_t>(section.entry.offset));
  }
  layout::Header header{};
  header.major = header_.model_major;
  header.minor = header_.model_minor;
  header.section_count = static_cast<std::uint32_t>(sections_.size());
  header.levels = packet_;
  if (packet_ == header_.levels) std::memcpy(header.reserved, header_.model_reserved, sizeof(header.reserved));
  seal(file, header);
  return file;
}

}  // namespace

StreamResult unpack(std::span<const std::byte> stream, UnpackedModel& unpacked, std::uint32_t levels) {
  StreamResult result;
  unpacked = {};
  StreamReader reader(stream, result);
  if (!reader.read_header()) return result;
  unpacked.stream_levels = reader.header().levels;
  const std::uint32_t wanted = std::min<std::uint32_t>(levels, reader.header().levels);
  while (reader.packets() < wanted && reader.read_packet()) continue;
  if (result.ok() && levels >= reader.header().levels && !reader.finish()) return result;
  if ((!result.ok() && result.rule != StreamRule::truncated) || reader.packets() == 0) return result;

  const AlignedBytes model(reader.model());
  ModelView view;
  const VerifyResult verdict = verify(model.span(), view);
  if (verdict.ok()) {
    unpacked.model.assign(model.span().begin(), model.span().end());
    unpacked.levels = reader.packets();
  } else if (result.ok()) {
    result = {StreamRule::not_a_model, reader.packets() - 1, 0, "model", 0, 0, greenloop::describe(verdict)};
  }
  return result;
}

const char* rule_name(StreamRule rule) {
  constexpr std::array names{
      "ok",           "truncated", "bad_magic",        "unsupported_version", "header_checksum", "packet_checksum",
      "out_of_range", "damaged",   "content_checksum", "trailing_bytes",      "not_a_model"};
  return names[static_cast<std::size_t>(rule)];
}

std::string describe(const StreamResult& result) {
  const std::string where = fmt::format("packet {}, offset {}, {}", result.packet, result.offset, result.field);
  const std::string found =
      fmt::format("found {}, expected or limit {} ({})", result.value, result.limit, rule_name(result.rule));
  switch (result.rule) {
    case StreamRule::ok:
      return "the stream is whole";
    case StreamRule::truncated:
      return fmt::format("{}: the stream ends here: {}; fetch the rest of it", where, found);
    case StreamRule::bad_magic:
      return "the stream does not begin with \"GREENLZ\" (bad_magic): it is not the transport form of a model";
    case StreamRule::unsupported_version:
      return fmt::format("{}: {}; use the release that wrote it", where, found);
    case StreamRule::damaged:
    case StreamRule::not_a_model:
      return fmt::format("{}: {} ({}); fetch the stream again or pack the model again", where, result.reason,
                         rule_name(result.rule));
    default:
      return fmt::format("{}: {}; the stream is damaged: fetch it again", where, found);
  }
}

}  // namespace greenloop::transport
