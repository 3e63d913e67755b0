#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop {

/// CRC-32C (Castagnoli, reflected polynomial 0x82F63B78) of `bytes`, as in RFC 3720 appendix B.4.
/// `crc` continues a checksum: crc32c(b, crc32c(a)) is that of a followed by b.
/// Work: linear in the bytes. No heap, no exception; may be called in the loop.
[[nodiscard]] std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0) noexcept;

}  // namespace greenloop
