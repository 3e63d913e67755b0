#include "runtime/impulse_response/moving_body.hpp"

#include "runtime/impulse_response/appearance.hpp"

namespace greenloop {
namespace {

// what pieces take, in instructions
/// Of the states of a step, of an orbit entered, and of one continued in another: themselves, by modes, by groups.
struct StateUnits {
  std::uint64_t itself, mode, group, transfer_mode;

  [[nodiscard]] std::uint64_t of(const ImpulseResponseView& view) const {
    return itself + mode * view.modes + group * view.levels + transfer_mode * view.appearance.modes;
  }
};
constexpr StateUnits step_units = {410, 64, 75, 24}, enter_units = {60, 20, 45, 10}, continue_units = {100, 45, 90, 22};
constexpr std::uint64_t field_units = 150, whole_units = 45;  // of a field, of a pair of coordinates

// Of a block of vertices or of a chosen one: itself, then by planes, by groups of modes, and by pairs of modes in each.
struct SumUnits {
  std::uint64_t itself, plane, group, pair;
};
constexpr SumUnits block_units = {140, 20, 23, 23}, vertex_units = {80, 18, 40, 24};

// Of colours: a light on a state, then of a block of vertices or a chosen one; each itself and by transfer modes.
struct ColourUnits {
  std::uint64_t itself, mode;

  [[nodiscard]] std::uint64_t of(std::uint32_t modes) const { return itself + mode * modes; }
};
constexpr ColourUnits lit_units = {1750, 870}, lit_block_units = {700, 292}, lit_vertex_units = {170, 495};

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
  if (view.appearance.modes > 0) placed.lit = arena.take_zeroed<std::int16_t>(lit_numbers(view.appearance.modes));
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

std::uint64_t colour_work(std::uint32_t vertices, std::uint32_t transfer_modes) noexcept {
  const std::uint64_t blocks = (std::uint64_t{vertices} + layout::block_vertices - 1) / layout::block_vertices;
  return lit_units.of(transfer_modes) + blocks * lit_block_units.of(transfer_modes);
}

std::uint64_t chosen_colour_work(std::uint32_t vertices, std::uint32_t transfer_modes) noexcept {
  return lit_units.of(transfer_modes) + vertices * lit_vertex_units.of(transfer_modes);
}

}  // namespace greenloop
