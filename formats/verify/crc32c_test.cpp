#include "formats/verify/crc32c.hpp"

#include <doctest/doctest.h>

#include <array>
#include <random>
#include <string_view>
#include <vector>

namespace greenloop {
namespace {

std::uint32_t of(std::string_view text) { return crc32c(std::as_bytes(std::span(text))); }

std::uint32_t bit_by_bit(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x82F63B78 : crc >> 1;
  }
  return ~crc;
}

TEST_CASE("crc32c: published vectors") {
  CHECK(of("") == 0);
  CHECK(of("a") == 0xC1D04330);
  CHECK(of("123456789") == 0xE3069283);

  // RFC 3720, appendix B.4: 32 bytes each
  std::array<std::byte, 32> bytes{};
  CHECK(crc32c(bytes) == 0x8A9136AA);
  bytes.fill(std::byte{0xff});
  CHECK(crc32c(bytes) == 0x62A8AB43);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
  CHECK(crc32c(bytes) == 0x46DD794E);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(31 - i);
  CHECK(crc32c(bytes) == 0x113FDB5C);
}

TEST_CASE("crc32c: every length and alignment agrees with the definition, in one piece or two") {
  std::mt19937_64 random(1);
  std::vector<std::byte> bytes(300);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  const std::span<const std::byte> all(bytes);
  for (std::size_t start = 0; start < 9; ++start) {
    for (std::size_t length = 0; length + start <= 100; ++length) {
      const auto part = all.subspan(start, length);
      const std::uint32_t expected = bit_by_bit(part);
      REQUIRE(crc32c(part) == expected);
      REQUIRE(crc32c(part.subspan(length / 3), crc32c(part.first(length / 3))) == expected);
    }
  }
}

}  // namespace
}  // namespace greenloop
