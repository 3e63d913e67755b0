#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop {

/// The 64-bit hash FNV-1a of everything added so far (Fowler, Noll, Vo; draft-eastlake-fnv). For the loop.
class Fnv1a {
 public:
  constexpr Fnv1a() = default;
  /// Goes on from a value that another had.
  explicit constexpr Fnv1a(std::uint64_t value) : value_(value) {}

  void add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) add_word(static_cast<std::uint64_t>(byte));
  }

  /// A whole word at once, which is another hash than that of its bytes.
  void add_word(std::uint64_t word) noexcept { value_ = (value_ ^ word) * prime; }

  /// The bits of each as a word.
  void add_words(std::span<const float> values) noexcept {
    for (const float value : values) add_word(std::bit_cast<std::uint32_t>(value));
  }

  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return value_; }

  static constexpr std::uint64_t prime = 0x100000001b3;

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace greenloop
