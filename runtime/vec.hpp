#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace greenloop {

/// A place, a direction or a force.
struct Vec3 {
  float x = 0, y = 0, z = 0;
};

/// The same in four floats, of which the last is 0, at a multiple of 16 bytes: an element of a field.
struct alignas(16) Vec4 {
  float x = 0, y = 0, z = 0, w = 0;
};

static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(Vec4) == 4 * sizeof(float));

namespace detail {
template <class To, class From>
std::span<To> view_as(std::span<From> from) noexcept {
  const bool fits =
      from.size_bytes() % sizeof(To) == 0 && reinterpret_cast<std::uintptr_t>(from.data()) % alignof(To) == 0;
  return fits ? std::span<To>(reinterpret_cast<To*>(from.data()), from.size_bytes() / sizeof(To)) : std::span<To>();
}
}  // namespace detail

// Views of the same memory, constant work, for the loop. Empty if the floats are no whole number of vectors or do not
// start where a vector may.

inline std::span<Vec3> as_vec3(std::span<float> xyz) noexcept { return detail::view_as<Vec3>(xyz); }
template <class Float>
requires std::is_same_v<Float, const float> std::span<const Vec3> as_vec3(std::span<Float> xyz)
noexcept { return detail::view_as<const Vec3>(xyz); }
inline std::span<Vec4> as_vec4(std::span<float> xyz0) noexcept { return detail::view_as<Vec4>(xyz0); }
template <class Float>
requires std::is_same_v<Float, const float> std::span<const Vec4> as_vec4(std::span<Float> xyz0)
noexcept { return detail::view_as<const Vec4>(xyz0); }

inline std::span<float> as_floats(std::span<Vec3> vectors) noexcept { return detail::view_as<float>(vectors); }
inline std::span<float> as_floats(std::span<Vec4> vectors) noexcept { return detail::view_as<float>(vectors); }

}  // namespace greenloop
