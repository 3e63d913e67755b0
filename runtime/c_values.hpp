#pragma once

#include <bit>
#include <cstddef>
#include <new>

#include "runtime/elastostatic.hpp"
#include "runtime/greenloop.h"

// What the functions of greenloop.h are given and give, in C++; for their sources alone.

namespace greenloop {

/// Whether an enumerator of C stands for one of C++.
template <class C, class Cpp>
constexpr bool same(C c, Cpp cpp) {
  return static_cast<int>(c) == static_cast<int>(cpp);
}

/// The text of an enumerator.
template <std::size_t count>
const char* text_at(const char* const (&texts)[count], unsigned index) {
  return index < count ? texts[index] : "unknown";
}

inline const Model& model_in(const greenloop_model* model) {
  return *std::launder(reinterpret_cast<const Model*>(model->storage));
}

inline Elastostatic body_in(greenloop_elastostatic* body) {
  return std::bit_cast<Elastostatic>(reinterpret_cast<Body*>(body));
}

[[nodiscard]] Elastostatic::Limits limits_of(greenloop_elastostatic_limits limits) noexcept;

inline std::span<const Constraint> constraints_of(const greenloop_constraint* constraints, std::size_t count) {
  return {reinterpret_cast<const Constraint*>(constraints), count};
}

inline Elastostatic::Response response_of(std::size_t count, float* force, float* displacement, std::uint32_t nodes) {
  const std::span<Vec4> field(reinterpret_cast<Vec4*>(displacement), displacement == nullptr ? 0 : nodes);
  return {{reinterpret_cast<Vec3*>(force), count}, field};
}

[[nodiscard]] Elastostatic::Loads loads_of(const greenloop_loads& loads) noexcept;

[[nodiscard]] greenloop_elastostatic_report report_of(const Elastostatic::StepReport& report) noexcept;

}  // namespace greenloop
