#pragma once

// A carry-propagating binary range coder (Martin 1979; the carry as in the LZMA coder of I. Pavlov).

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace greenloop::transport {

/// Coded bytes that no encoder writes: a packet that ends too early, or a count that cannot be.
class DamagedPacket : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Codes binary decisions. A model calls it in the same way in both directions, so that what is written and what is
/// read cannot diverge.
class BitCoder {
 public:
  BitCoder() = default;
  BitCoder(const BitCoder&) = delete;
  BitCoder& operator=(const BitCoder&) = delete;
  virtual ~BitCoder() = default;

  /// An encoder writes `bit` and returns it, a decoder returns the one it reads. `probability` of a one in 1/65536,
  /// 1 .. 65535.
  virtual bool code(bool bit, std::uint32_t probability) = 0;

  /// The `count` low bits of `value`, at most 64, the highest first, each as likely 0 as 1.
  std::uint64_t code_plain(std::uint64_t value, std::uint32_t count);
};

/// No more decisions than this a byte: what is crafted to be read for ever is refused.
inline constexpr std::uint64_t most_decisions_per_byte = 128;

/// Writes decisions into bytes.
class RangeEncoder final : public BitCoder {
 public:
  bool code(bool bit, std::uint32_t probability) override;

  /// The bytes of all decisions, with zeros after them if there are fewer than `least` or too few for the decisions.
  /// Call once, last.
  [[nodiscard]] std::vector<std::byte> finish(std::size_t least);

 private:
  void shift();

  std::uint64_t low_ = 0;  // 32 bits and a carry
  std::uint32_t range_ = 0xffffffff;
  std::uint64_t held_ = 0;  // bytes that a carry may still change: `pending_`, then held_ - 1 times 0xff
  std::uint8_t pending_ = 0;
  std::uint64_t decisions_ = 0;
  std::vector<std::byte> bytes_;
};

/// Reads decisions back. Throws DamagedPacket when asked for more than `bytes` hold.
class RangeDecoder final : public BitCoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes);
  bool code(bool bit, std::uint32_t probability) override;

 private:
  void shift();

  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
  std::uint64_t decisions_left_;
  std::uint32_t code_ = 0;  // distance from the low end
  std::uint32_t range_ = 0xffffffff;
};

}  // namespace greenloop::transport
