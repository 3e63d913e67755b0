#include "formats/testing/reseal_stream.hpp"

#include <cstring>
#include <span>

#include "formats/transport/stream.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop::transport {

void reseal_stream(std::vector<std::byte>& stream) {
  const auto seal = [&](std::size_t at, std::size_t place) {
    const std::uint32_t crc = crc32c(std::span(stream).subspan(at, place));
    std::memcpy(stream.data() + at + place, &crc, sizeof(crc));
  };
  if (stream.size() < sizeof(StreamHeader)) return;
  seal(0, offsetof(StreamHeader, header_crc));
  for (std::size_t at = sizeof(StreamHeader); stream.size() - at >= sizeof(PacketHeader);) {
    PacketHeader packet;
    std::memcpy(&packet, stream.data() + at, sizeof(packet));
    const std::size_t left = stream.size() - at - sizeof(packet);
    if (packet.coded_bytes > left) return seal(at, offsetof(PacketHeader, header_crc));
    const auto coded = std::span(stream).subspan(at + sizeof(packet), packet.coded_bytes);
    packet.coded_crc = crc32c(coded);
    std::memcpy(stream.data() + at, &packet, sizeof(packet));
    seal(at, offsetof(PacketHeader, header_crc));
    at += sizeof(packet) + coded.size();
  }
}

}  // namespace greenloop::transport
