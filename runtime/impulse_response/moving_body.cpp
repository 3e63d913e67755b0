#include "runtime/impulse_response/moving_body.hpp"

namespace greenloop {
namespace {

// instructions, fitted by rt_tests/instructions
constexpr std::uint64_t step_units = 400, mode_units = 40, group_units = 60;
constexpr std::uint64_t field_units = 150, whole_units = 20;        // of a field, of a pair of its coordinates
constexpr std::uint64_t block_units = 90, block_pair_units = 24;    // of a block, of a pair and plane in it
constexpr std::uint64_t vertex_units = 60, vertex_pair_units = 24;  // of a chosen vertex likewise

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

std::uint64_t state_work(const ImpulseResponseView& view) noexcept {
  return step_units + mode_units * view.modes + group_units * view.levels;
}

std::uint64_t field_work(std::uint32_t vertices, std::uint32_t fields, Fineness fineness) noexcept {
  const std::uint64_t blocks = (std::uint64_t{vertices} + layout::block_vertices - 1) / layout::block_vertices;
  const std::uint64_t block = block_units + block_pair_units * fineness.pairs * fineness.planes;
  return fields * (field_units + whole_units * fineness.pairs + blocks * block);
}

std::uint64_t chosen_work(std::uint32_t vertices, std::uint32_t fields, Fineness fineness) noexcept {
  const std::uint64_t vertex = vertex_units + vertex_pair_units * fineness.pairs * fineness.planes;
  return fields * (field_units + whole_units * fineness.pairs + vertices * vertex);
}

}  // namespace greenloop
