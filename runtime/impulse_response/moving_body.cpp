#include "runtime/impulse_response/moving_body.hpp"

namespace greenloop {
namespace {

// what pieces take, in instructions
/// Of the states of a step, of an orbit entered, and of one continued in another: themselves, by modes, by groups.
struct StateUnits {
  std::uint64_t itself, mode, group;

  [[nodiscard]] std::uint64_t of(const ImpulseResponseView& view) const {
    return itself + mode * view.modes + group * view.levels;
  }
};
constexpr StateUnits step_units = {410, 64, 75}, enter_units = {60, 20, 45}, continue_units = {100, 45, 90};
constexpr std::uint64_t field_units = 150, whole_units = 45;  // of a field, of a pair of coordinates

// Of a block of vertices or of a chosen one: itself, then by planes, by groups of modes, and by pairs of modes in each.
struct SumUnits {
  std::uint64_t itself, plane, group, pair;
};
constexpr SumUnits block_units = {140, 20, 23, 23}, vertex_units = {80, 18, 40, 24};

std::uint64_t sums_work(const ImpulseResponseView& view, std::uint64_t sums, std::uint32_t fields, Fineness fineness,
                        const SumUnits& units) {
  const std::uint64_t of_plane = units.plane + units.group * view.levels + units.pair * fineness.pairs;
  const std::uint64_t of_field = field_units + whole_units * fineness.pairs;
  return fields * (of_field + sums * (units.itself + fineness.planes * of_plane));
}

}  // namespace

MovingBody* place_body(Arena& arena, const ImpulseResponseView& view) noexcept {
  MovingBody* const body = arena.take_zeroed<MovingBody>(1);
  MovingBody counted;
  MovingBody& placed = body == nullptr ? counted : *body;
  placed = {};
  placed.view = view;
  placed.player.carve(arena, placed.view);
  placed.whole = arena.take_zeroed<std::int16_t>(view.modes);
  return body;
}

std::uint64_t state_work(const ImpulseResponseView& view, std::uint32_t entered, std::uint32_t continued) noexcept {
  return step_units.of(view) + entered * enter_units.of(view) + continued * continue_units.of(view);
}

std::uint64_t field_work(const ImpulseResponseView& view, std::uint32_t vertices, std::uint32_t fields,
                         Fineness fineness) noexcept {
  const std::uint64_t blocks = (std::uint64_t{vertices} + layout::block_vertices - 1) / layout::block_vertices;
  return sums_work(view, blocks, fields, fineness, block_units);
}

std::uint64_t chosen_work(const ImpulseResponseView& view, std::uint32_t vertices, std::uint32_t fields,
                          Fineness fineness) noexcept {
  return sums_work(view, vertices, fields, fineness, vertex_units);
}

}  // namespace greenloop
