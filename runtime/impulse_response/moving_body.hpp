#pragma once

#include <cstdint>

#include "runtime/impulse_response.hpp"
#include "runtime/impulse_response/orbit_player.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// What a body of an impulse response model keeps in its arena.
struct MovingBody {
  ImpulseResponseView view;
  OrbitPlayer player;
  std::int16_t* whole = nullptr;  ///< [modes] coordinates as sums take them
  std::int16_t* lit = nullptr;    ///< [lit_numbers(transfer modes)] light as sums take it; none without appearance
  bool avx2 = false;              ///< whether the processor has it
  std::uint64_t least_work = 0;   ///< units of a step without displacements, at most
  std::uint64_t worst_work = 0;   ///< units of any step, at most
};

/// The body in an arena; null while that counts. Start-up.
[[nodiscard]] MovingBody* place_body(Arena& arena, const ImpulseResponseView& view) noexcept;

/// How finely modes are summed.
struct Fineness {
  std::uint32_t pairs = 0;   ///< of modes
  std::uint32_t planes = 0;  ///< of their values
};

// Work units: instructions of x86-64 with AVX2.

/// Of a step but for displacements, with so many orbits entered and continued. Constant.
[[nodiscard]] std::uint64_t state_work(const ImpulseResponseView& view, std::uint32_t entered,
                                       std::uint32_t continued) noexcept;
/// Of `fields` fields, displacements or their rates, of the first `vertices` vertices. Constant.
[[nodiscard]] std::uint64_t field_work(const ImpulseResponseView& view, std::uint32_t vertices, std::uint32_t fields,
                                       Fineness fineness) noexcept;
/// The same of as many chosen vertices. Constant.
[[nodiscard]] std::uint64_t chosen_work(const ImpulseResponseView& view, std::uint32_t vertices, std::uint32_t fields,
                                        Fineness fineness) noexcept;

/// Of colours of the first `vertices` vertices by so many transfer modes. Constant.
[[nodiscard]] std::uint64_t colour_work(std::uint32_t vertices, std::uint32_t transfer_modes) noexcept;
/// The same of as many chosen vertices. Constant.
[[nodiscard]] std::uint64_t chosen_colour_work(std::uint32_t vertices, std::uint32_t transfer_modes) noexcept;

}  // namespace greenloop
