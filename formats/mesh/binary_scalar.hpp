#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace greenloop {

/// The numbers of binary mesh files.
enum class Scalar { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

[[nodiscard]] constexpr std::size_t size_of(Scalar type) {
  constexpr std::array<std::size_t, 10> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// The T whose sizeof(T) bytes these are.
template <typename T>
[[nodiscard]] T decode_as(const char* bytes, std::endian order) {
  std::array<char, sizeof(T)> copy{};
  std::memcpy(copy.data(), bytes, sizeof(T));
  if (order != std::endian::native) {
    std::reverse(copy.begin(), copy.end());
  }
  return std::bit_cast<T>(copy);
}

/// The number in size_of(type) bytes; whole ones beyond 2^53 are rounded.
[[nodiscard]] inline double decode(Scalar type, const char* bytes, std::endian order) {
  const auto number = [&]<typename T>(T) { return static_cast<double>(decode_as<T>(bytes, order)); };
  switch (type) {
    case Scalar::i8:
      return number(std::int8_t{});
    case Scalar::u8:
      return number(std::uint8_t{});
    case Scalar::i16:
      return number(std::int16_t{});
    case Scalar::u16:
      return number(std::uint16_t{});
    case Scalar::i32:
      return number(std::int32_t{});
    case Scalar::u32:
      return number(std::uint32_t{});
    case Scalar::i64:
      return number(std::int64_t{});
    case Scalar::u64:
      return number(std::uint64_t{});
    case Scalar::f32:
      return number(float{});
    case Scalar::f64:
      break;
  }
  return number(double{});
}

}  // namespace greenloop
