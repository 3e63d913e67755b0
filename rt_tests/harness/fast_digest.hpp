#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {

/// A digest that takes eight bytes at a time, so that a whole field costs little; rotated, so that every bit reaches
/// all.
class FastDigest {
 public:
  /// Filled up with zeros to a whole number of words.
  void add(std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + i, std::min(sizeof word, bytes.size() - i));
      value_ = std::rotl(value_ ^ word, 29) * Fnv1a::prime;
    }
  }

  template <class T>
  void add(std::span<const T> values) {
    add(std::as_bytes(values));
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = Fnv1a{}.value();
};

}  // namespace greenloop
