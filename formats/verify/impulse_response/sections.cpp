#include "formats/verify/impulse_response/sections.hpp"

#include <cstring>

namespace greenloop::impulse_response {
namespace {

using layout::ImpulseInfo;
using layout::none;
using layout::OrbitRecord;
using layout::ReferenceRecord;

// most rows, vertices and triangles: products with them stay far from 2^64
constexpr std::uint32_t most_records = 1U << 28;

bool verify_sizes(SectionCheck& check, const ImpulseInfo& info) {
  const struct {
    const char* name;
    std::uint32_t value, least, most;
  } sizes[] = {{"levels", info.levels, 1, layout::max_levels},
               {"modes", info.modes, 1, layout::most_modes},
               {"vertices", info.vertices, 1, most_records},
               {"triangles", info.triangles, 0, most_records},
               {"impulses", info.impulses, 1, layout::most_impulses},
               {"orbits", info.orbits, 1, most_records},
               {"rows", info.rows, 2, most_records},
               {"planes", info.planes, 1, layout::most_planes},
               {"transfer_modes", info.transfer_modes, 0, layout::most_transfer_modes}};
  for (const auto& size : sizes) {
    if (!check.require_at_least(size.name, 0, size.value, size.least) ||
        !check.require_at_most(size.name, 0, size.value, size.most)) {
      return false;
    }
  }
  return check.require_equal("components", 0, info.components, 3);
}

bool verify_box(SectionCheck& check, const ImpulseInfo& info) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (!check.require_finite("box_min", k, info.box_min[k]) ||
        !check.require_at_least("box_max", k, info.box_max[k], info.box_min[k])) {
      return false;
    }
  }
  return true;
}

// of what is stored of a mode: its amplitude and error
bool verify_mode(SectionCheck& check, const layout::ModeRecord& mode, std::uint32_t i) {
  return check.require_at_least("amplitude", i, mode.amplitude, 0) &&
         check.require_at_least("truncation_error", i, mode.truncation_error, 0);
}

// of i16: from -32767
bool verify_coordinate_rows(SectionCheck& check, const std::int16_t* values, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!check.require_at_least("coordinate", i, values[i], -layout::most_coordinate)) return false;
  }
  return true;
}

// what Info says of radiance transfer, of which there may be none
bool verify_appearance(SectionCheck& check, const ImpulseInfo& info) {
  const bool any = info.transfer_modes > 0;
  return check.require(any == (info.transfer_states > 0), VerifyRule::inconsistent, "transfer_states", 0,
                       info.transfer_states, info.transfer_modes) &&
         check.require_at_least("transfer_error", 0, info.transfer_error, 0) &&
         check.require_at_least("transfer_quantisation_error", 0, info.transfer_quantisation_error, 0);
}

bool verify_orbit(SectionCheck& check, const ImpulseResponseView& view, const OrbitRecord* records, std::uint32_t i) {
  const OrbitRecord& orbit = records[i];
  const std::uint32_t first = i == 0 ? 0 : records[i - 1].first_row + records[i - 1].rows;
  const std::uint32_t left = view.info->rows - first;
  const bool begun = orbit.impulse != none;
  return check.require_equal("first_row", i, orbit.first_row, first) &&
         check.require_at_least("rows", i, orbit.rows, 2) && check.require_at_most("rows", i, orbit.rows, left) &&
         check.require(begun == (i != 0), VerifyRule::inconsistent, "impulse", i, orbit.impulse, none) &&
         check.require(!begun || orbit.impulse < view.info->impulses, VerifyRule::out_of_range, "impulse", i,
                       orbit.impulse, view.info->impulses) &&
         check.require(orbit.reserved[0] == 0 && orbit.reserved[1] == 0, VerifyRule::reserved_not_zero, "reserved", i,
                       orbit.reserved[0], 0);
}

// where an orbit goes on: a state of its own impulse behind which there is another
bool verify_next(SectionCheck& check, const ImpulseResponseView& view, const OrbitRecord* records, std::uint32_t i) {
  const OrbitRecord& orbit = records[i];
  if (orbit.next_orbit == none) {
    return check.require_equal("next_row", i, orbit.next_row, none) &&
           check.require_equal("next_distance", i, orbit.next_distance, 0);
  }
  if (!check.require(i != 0, VerifyRule::inconsistent, "next_orbit", i, orbit.next_orbit, none) ||
      !check.require(orbit.next_orbit < view.info->orbits, VerifyRule::out_of_range, "next_orbit", i, orbit.next_orbit,
                     view.info->orbits)) {
    return false;
  }
  const OrbitRecord& next = records[orbit.next_orbit];
  return check.require_equal("next_orbit", i, next.impulse, orbit.impulse) &&
         check.require(orbit.next_row > next.first_row && orbit.next_row < next.first_row + next.rows - 1,
                       VerifyRule::out_of_range, "next_row", i, orbit.next_row, next.first_row + next.rows - 1) &&
         check.require_at_least("next_distance", i, orbit.next_distance, 0);
}

bool may_follow(const ImpulseResponseView& view, std::uint32_t before, std::uint32_t impulse) {
  const std::uint32_t row = before == none ? view.info->impulses : before;
  return view.successions[std::size_t{row} * view.info->impulses + impulse] != 0;
}

bool verify_reference(SectionCheck& check, const ImpulseResponseView& view, std::uint32_t before, std::uint32_t impulse,
                      std::uint64_t index, const ReferenceRecord& reference) {
  if (!may_follow(view, before, impulse)) {
    return check.require_equal("orbit", index, reference.orbit, none) &&
           check.require_equal("distance", index, reference.distance, 0);
  }
  return check.require(reference.orbit < view.orbits.size(), VerifyRule::out_of_range, "orbit", index, reference.orbit,
                       static_cast<double>(view.orbits.size())) &&
         check.require_equal("orbit", index, view.orbits[reference.orbit].impulse, impulse) &&
         check.require_at_least("distance", index, reference.distance, 0);
}

bool verify_name(SectionCheck& check, const layout::ImpulseRecord& record, std::uint32_t i) {
  constexpr std::size_t room = sizeof(record.name);
  std::size_t length = 0;
  while (length < room && record.name[length] != 0) ++length;
  if (!check.require(length > 0 && length < room, VerifyRule::out_of_range, "name", i, static_cast<double>(length),
                     room - 1)) {
    return false;
  }
  for (std::size_t k = 0; k < room; ++k) {
    const bool right = k < length ? record.name[k] >= ' ' && record.name[k] <= '~' : record.name[k] == 0;
    if (!check.require(right, VerifyRule::out_of_range, "name", i, record.name[k], '~')) return false;
  }
  return true;
}

}  // namespace

bool verify_info(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(ImpulseInfo))) return false;
  const auto& info = *section.as<ImpulseInfo>();
  context.view.info = &info;
  return verify_sizes(check, info) &&
         check.require(info.levels >= context.levels, VerifyRule::inconsistent, "levels", 0, info.levels,
                       context.levels) &&
         check.require_above("time_step", 0, info.time_step, 0) && check.require_above("rate", 0, info.rate, 0) &&
         check.require_above("blend_rate", 0, info.blend_rate, 0) &&
         check.require_above("velocity_balance", 0, info.velocity_balance, 0) &&
         check.require_at_least("quantisation_error", 0, info.quantisation_error, 0) && verify_box(check, info) &&
         check.require_at_least("displacement", 0, info.displacement, 0) && verify_appearance(check, info) &&
         check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(info.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

bool verify_level(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(sizeof(layout::ImpulseLevel))) return false;
  const auto& level = *section.as<layout::ImpulseLevel>();
  ImpulseResponseView& view = context.view;
  const std::uint32_t most = view.info->modes - view.modes;
  view.group[section.a].counts = &level;
  view.modes += level.modes <= most ? level.modes : 0;
  return check.require_at_least("modes", 0, level.modes, 2) && check.require_at_most("modes", 0, level.modes, most) &&
         check.require(level.modes % 2 == 0, VerifyRule::out_of_range, "modes", 0, level.modes, most) &&
         check.require_equal("mode_end", 0, level.mode_end, view.modes) &&
         check.require_at_least("truncation_error", 0, level.truncation_error, 0) &&
         check.require_at_least("worst_error", 0, level.worst_error, 0) &&
         check.require(!context.reserved_is_zero || all_zero(std::as_bytes(std::span(level.reserved))),
                       VerifyRule::reserved_not_zero, "reserved", 0, 1, 0);
}

bool verify_shape(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(context.view.info->vertices)) return false;
  context.view.shape = section.as<float>();
  for (std::uint64_t i = 0; i < std::uint64_t{3} * context.view.info->vertices; ++i) {
    if (!check.require_finite("position", i, context.view.shape[i])) return false;
  }
  return true;
}

bool verify_triangles(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t vertices = context.view.info->vertices;
  if (!check.require_count(context.view.info->triangles)) return false;
  context.view.triangles = section.as<std::uint32_t>();
  for (std::uint64_t i = 0; i < std::uint64_t{3} * context.view.info->triangles; ++i) {
    const std::uint32_t vertex = context.view.triangles[i];
    if (!check.require(vertex < vertices, VerifyRule::out_of_range, "vertex", i, vertex, vertices)) return false;
  }
  return true;
}

bool verify_quanta(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  if (!check.require_count(context.view.blocks())) return false;
  context.view.quanta = section.as<float>();
  for (std::uint32_t i = 0; i < context.view.blocks(); ++i) {
    if (!check.require_at_least("quantum", i, context.view.quanta[i], 0)) return false;
  }
  return true;
}

bool verify_impulses(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t count = context.view.info->impulses;
  if (!check.require_count(count)) return false;
  context.view.impulses = {section.as<layout::ImpulseRecord>(), count};
  for (std::uint32_t i = 0; i < count; ++i) {
    const layout::ImpulseRecord& record = context.view.impulses[i];
    if (!verify_name(check, record, i)) return false;
    for (std::uint32_t k = 0; k < i; ++k) {
      if (!check.require(std::memcmp(context.view.impulses[k].name, record.name, sizeof(record.name)) != 0,
                         VerifyRule::inconsistent, "name", i, i, k)) {
        return false;
      }
    }
    for (const float value : record.initial) {
      if (!check.require_finite("initial", i, value)) return false;
    }
    for (const float value : record.persistent) {
      if (!check.require_finite("persistent", i, value)) return false;
    }
  }
  return true;
}

bool verify_successions(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint64_t count = (std::uint64_t{context.view.info->impulses} + 1) * context.view.info->impulses;
  if (!check.require_count(count)) return false;
  context.view.successions = section.as<std::uint8_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!check.require_at_most("may_follow", i, context.view.successions[i], 1)) return false;
  }
  return true;
}

bool verify_orbits(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t count = context.view.info->orbits;
  if (!check.require_count(count)) return false;
  const auto* const records = section.as<OrbitRecord>();
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_orbit(check, context.view, records, i)) return false;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!verify_next(check, context.view, records, i)) return false;
  }
  context.view.orbits = {records, count};
  const std::uint32_t end = records[count - 1].first_row + records[count - 1].rows;
  return check.require_equal("rows", count - 1, end, context.view.info->rows);
}

bool verify_references(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const ImpulseResponseView& view = context.view;
  const std::uint32_t impulses = view.info->impulses;
  if (!check.require_count(std::uint64_t{view.info->rows} * impulses)) return false;
  const auto* const records = section.as<ReferenceRecord>();
  for (const OrbitRecord& orbit : view.orbits) {
    for (std::uint32_t row = orbit.first_row; row < orbit.first_row + orbit.rows; ++row) {
      for (std::uint32_t impulse = 0; impulse < impulses; ++impulse) {
        const std::uint64_t index = std::uint64_t{row} * impulses + impulse;
        if (!verify_reference(check, view, orbit.impulse, impulse, index, records[index])) return false;
      }
    }
  }
  context.view.references = records;
  return true;
}

bool verify_modes(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ModeGroupView& group = context.view.group[section.a];
  const std::uint64_t count = std::uint64_t{context.view.blocks()} * layout::block_values * group.counts->modes;
  if (!check.require_count(count)) return false;
  const auto* const values = section.as<std::int8_t>();
  group.plane[section.b] = values;
  for (std::uint64_t i = 0; section.b == 0 && i < count; ++i) {
    if (!check.require_at_least("value", i, values[i], -127)) return false;
  }
  return true;
}

bool verify_amplitudes(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ModeGroupView& group = context.view.group[section.a];
  if (!check.require_count(group.counts->modes)) return false;
  group.amplitudes = section.as<layout::ModeRecord>();
  for (std::uint32_t i = 0; i < group.counts->modes; ++i) {
    if (!verify_mode(check, group.amplitudes[i], i)) return false;
  }
  return true;
}

bool verify_coordinates(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  ModeGroupView& group = context.view.group[section.a];
  const std::uint64_t count = std::uint64_t{context.view.info->rows} * group.counts->modes;
  if (!check.require_count(count)) return false;
  group.coordinates = section.as<std::int16_t>();
  return verify_coordinate_rows(check, group.coordinates, count);
}

bool verify_transfer_quanta(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t blocks = context.view.blocks();
  if (!check.require_count(blocks)) return false;
  context.view.appearance.quanta = section.as<float>();
  for (std::uint64_t i = 0; i < std::uint64_t{2} * blocks; ++i) {
    if (!check.require_at_least("quantum", i, context.view.appearance.quanta[i], 0)) return false;
  }
  return true;
}

bool verify_transfers(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint64_t bytes = layout::transfer_bytes(context.view.info->transfer_modes);
  context.view.appearance.transfers = section.as<std::int8_t>();
  return check.require_count(bytes * layout::colours * context.view.blocks());  // every value is right
}

bool verify_transfer_amplitudes(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  const std::uint32_t modes = context.view.info->transfer_modes;
  if (!check.require_count(modes)) return false;
  context.view.appearance.amplitudes = section.as<layout::ModeRecord>();
  for (std::uint32_t i = 0; i < modes; ++i) {
    if (!verify_mode(check, context.view.appearance.amplitudes[i], i)) return false;
  }
  return true;
}

bool verify_transfer_coordinates(const Section& section, VerifyContext& context) {
  SectionCheck check(section, context.result);
  AppearanceView& appearance = context.view.appearance;
  const std::uint64_t count = std::uint64_t{context.view.info->rows} * context.view.info->transfer_modes;
  if (!check.require_count(count)) return false;
  appearance.coordinates = section.as<std::int16_t>();
  appearance.modes = context.view.info->transfer_modes;
  return verify_coordinate_rows(check, appearance.coordinates, count);
}

}  // namespace greenloop::impulse_response
