#include "formats/transport/range_coder.hpp"

#include <algorithm>
#include <utility>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t least_range = 1U << 24;

std::uint32_t share(std::uint32_t range, std::uint32_t probability) {
  return static_cast<std::uint32_t>(std::uint64_t{range} * probability >> 16);
}

}  // namespace

std::uint64_t BitCoder::code_plain(std::uint64_t value, std::uint32_t count) {
  std::uint64_t coded = 0;
  while (count-- > 0) coded = coded << 1 | static_cast<std::uint64_t>(code((value >> count & 1) != 0, 1U << 15));
  return coded;
}

bool RangeEncoder::code(bool bit, std::uint32_t probability) {
  ++decisions_;
  const std::uint32_t ones = share(range_, probability);
  if (bit) {
    range_ = ones;
  } else {
    low_ += ones;
    range_ -= ones;
  }
  while (range_ < least_range) {
    range_ <<= 8;
    shift();
  }
  return bit;
}

// The highest byte of `low_` is final unless it is 0xff, which a later carry turns into 0x00 and passes on.
void RangeEncoder::shift() {
  const auto carry = static_cast<std::uint8_t>(low_ >> 32);
  const auto top = static_cast<std::uint8_t>(low_ >> 24);
  if (held_ == 0 || top != 0xff || carry != 0) {
    if (held_ > 0) {
      bytes_.push_back(static_cast<std::byte>(pending_ + carry));
      bytes_.insert(bytes_.end(), static_cast<std::size_t>(held_ - 1), static_cast<std::byte>(0xff + carry));
    }
    pending_ = top;
    held_ = 0;
  }
  ++held_;
  low_ = (low_ & 0xffffff) << 8;
}

std::vector<std::byte> RangeEncoder::finish(std::size_t least) {
  for (int i = 0; i < 5; ++i) shift();  // four bytes of `low_`, and one more to let go of what is held
  const auto enough = static_cast<std::size_t>(decisions_ / most_decisions_per_byte + 1);
  bytes_.resize(std::max({bytes_.size(), enough, least}));
  return std::move(bytes_);
}

RangeDecoder::RangeDecoder(std::span<const std::byte> bytes)
    : bytes_(bytes), decisions_left_(most_decisions_per_byte * bytes.size()) {
  for (int i = 0; i < 4; ++i) shift();
}

bool RangeDecoder::code(bool /*bit*/, std::uint32_t probability) {
  if (decisions_left_-- == 0) throw DamagedPacket("it holds more than its coded bytes can");
  const std::uint32_t ones = share(range_, probability);
  const bool bit = code_ < ones;
  if (bit) {
    range_ = ones;
  } else {
    code_ -= ones;
    range_ -= ones;
  }
  while (range_ < least_range) {
    range_ <<= 8;
    shift();
  }
  return bit;
}

void RangeDecoder::shift() {
  if (next_ == bytes_.size()) throw DamagedPacket("its coded bytes end too early");
  code_ = code_ << 8 | std::to_integer<std::uint32_t>(bytes_[next_++]);
}

}  // namespace greenloop::transport
