#include "offline/cli/inspect_motion.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "formats/write/describe.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

/// How far a state is from the start of the orbit of an impulse that may follow.
struct Distances {
  float median = 0, worst = 0;
};

Distances distances_of(const ImpulseResponseView& view, std::uint32_t impulse) {
  std::vector<float> distances;
  for (std::uint32_t row = 0; row < view.info->rows; ++row) {
    const auto& reference = view.references[std::size_t{row} * view.info->impulses + impulse];
    if (reference.orbit != layout::none) distances.push_back(reference.distance);
  }
  if (distances.empty()) return {};
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return {*middle, *std::max_element(distances.begin(), distances.end())};
}

Json impulses_of(const ImpulseResponseView& view) {
  Json impulses = Json::array();
  for (std::uint32_t i = 0; i < view.impulses.size(); ++i) {
    const auto begun = [&](const layout::OrbitRecord& orbit) { return orbit.impulse == i; };
    const Distances distances = distances_of(view, i);
    impulses.push_back({{"name", std::string(view.impulses[i].name)},
                        {"initial", view.impulses[i].initial},
                        {"persistent", view.impulses[i].persistent},
                        {"orbits", std::count_if(view.orbits.begin(), view.orbits.end(), begun)},
                        {"median_distance", distances.median},
                        {"worst_distance", distances.worst}});
  }
  return impulses;
}

Json levels_of(const ImpulseResponseView& view) {
  Json levels = Json::array();
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const layout::ImpulseLevel& counts = *view.group[q].counts;
    levels.push_back({{"level", q},
                      {"modes", counts.mode_end},
                      {"truncation_error", counts.truncation_error},
                      {"worst_error", counts.worst_error}});
  }
  return levels;
}

/// Truncation error by the number of modes, from one on.
Json rank_curve(const ImpulseResponseView& view) {
  Json errors = Json::array();
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    for (std::uint32_t m = 0; m < view.group[q].counts->modes; ++m) {
      errors.push_back(view.group[q].amplitudes[m].truncation_error);
    }
  }
  return errors;
}

/// Of its radiance transfer, relative to the variation; null if it has none.
Json appearance_of(const ImpulseResponseView& view) {
  if (view.appearance.modes == 0) return nullptr;
  Json errors = Json::array();
  for (std::uint32_t m = 0; m < view.appearance.modes; ++m)
    errors.push_back(view.appearance.amplitudes[m].truncation_error);
  return {{"states", view.info->transfer_states},
          {"error", view.info->transfer_error},
          {"quantisation_error", view.info->transfer_quantisation_error},
          {"rank_curve", errors}};
}

std::uint64_t resting_orbits(const ImpulseResponseView& view) {
  return static_cast<std::uint64_t>(std::count_if(view.orbits.begin(), view.orbits.end(),
                                                  [](const auto& orbit) { return orbit.next_orbit == layout::none; }));
}

Json recorded(const Json& provenance, const char* key) {
  return provenance.is_object() && provenance.contains(key) ? provenance[key] : Json(nullptr);
}

}  // namespace

Json motion_inspection(const ModelFile& model, const Json& provenance) {
  const ImpulseResponseView& view = model.view.impulse_response;
  const layout::ImpulseInfo& info = *view.info;
  const auto frame_bytes = std::uint64_t{info.vertices} * 3 * sizeof(float);
  return {{"kind", "impulse_response"},
          {"version", fmt::format("{}.{}", model.view.header->major, model.view.header->minor)},
          {"problem", problem_name(model.view.problem)},
          {"rank", view.modes},
          {"complete_rank", info.modes},
          {"rank_appearance", view.appearance.modes},
          {"levels", view.levels},
          {"states", info.rows},
          {"source_states", info.source_rows},
          {"orbits", info.orbits},
          {"resting_orbits", resting_orbits(view)},
          {"impulses", impulses_of(view)},
          {"vertices", info.vertices},
          {"triangles", info.triangles},
          {"bytes", model.bytes.size()},
          {"frame_bytes", frame_bytes},
          {"all_frames_bytes", frame_bytes * info.source_rows},
          {"bits", 8 * info.planes},
          {"time_step", info.time_step},
          {"rate", info.rate},
          {"blend_rate", info.blend_rate},
          {"velocity_balance", info.velocity_balance},
          {"displacement", info.displacement},
          {"truncation_error", view.group[view.levels - 1].counts->truncation_error},
          {"worst_error", view.group[view.levels - 1].counts->worst_error},
          {"quantisation_error", info.quantisation_error},
          {"replay_error", recorded(provenance, "replay_error")},
          {"penetrations", recorded(provenance, "penetrations")},
          {"mode_levels", levels_of(view)},
          {"rank_curve", rank_curve(view)},
          {"appearance", appearance_of(view)},
          {"box", {{"min", info.box_min}, {"max", info.box_max}}},
          {"provenance", provenance}};
}

void print_motion_table(const std::filesystem::path& file, const Json& found, std::ostream& out) {
  const auto row = [&](std::string_view name, const std::string& value) {
    fmt::print(out, "  {:<20}{}\n", name, value);
  };
  const auto percent = [&](const Json& value) { return fmt::format("{:.3g} %", 100 * value.get<double>()); };
  fmt::print(out, "{}  (format {})\n", file.string(), found["version"].get<std::string>());
  row("problem", found["problem"].get<std::string>());
  row("modes",
      fmt::format("{} of {}, {} bits", found["rank"].dump(), found["complete_rank"].dump(), found["bits"].dump()));
  row("vertices", fmt::format("{}, {} triangles", found["vertices"].dump(), found["triangles"].dump()));
  row("states", fmt::format("{} in {} orbits, a time step of {} s", found["states"].dump(), found["orbits"].dump(),
                            found["time_step"].dump()));
  row("bytes", fmt::format("{}: {:.0f} times fewer than the frames", found["bytes"].dump(),
                           found["all_frames_bytes"].get<double>() / found["bytes"].get<double>()));
  row("truncation error",
      fmt::format("{} RMS, {} in the worst state", percent(found["truncation_error"]), percent(found["worst_error"])));
  row("quantisation error", percent(found["quantisation_error"]) + " RMS");
  const Json& replay = found["replay_error"];
  row("replay error", replay.is_object()
                          ? fmt::format("{} median, {} in 95 of 100, of {} held-out orbits", percent(replay["median"]),
                                        percent(replay["p95"]), replay["orbits"].dump())
                          : "not measured: no orbit was held out");
  if (const Json& light = found["appearance"]; light.is_object()) {
    row("appearance", fmt::format("{} modes of {} states, {} of the variation in others, quantisation {}",
                                  found["rank_appearance"].dump(), light["states"].dump(), percent(light["error"]),
                                  percent(light["quantisation_error"])));
  }
  if (const Json& counts = found["penetrations"]; counts.is_object()) {
    const auto text = [](const Json& count) {
      return fmt::format("{} of {} frames", count["crossing_frames"].dump(), count["frames"].dump());
    };
    row("crosses itself",
        fmt::format("{} simulated, {} replayed", text(counts["simulated"]), text(counts["replayed"])));
  }
  row("loop", fmt::format("{} Hz; differences die out at {} 1/s", found["rate"].dump(), found["blend_rate"].dump()));
  fmt::print(out, "\n  {:<32}{:>8}{:>18}{:>18}\n", "impulse", "orbits", "median distance", "worst distance");
  for (const Json& impulse : found["impulses"]) {
    fmt::print(out, "  {:<32}{:>8}{:>16.3g} m{:>16.3g} m\n", impulse["name"].get<std::string>(),
               impulse["orbits"].dump(), impulse["median_distance"].get<double>(),
               impulse["worst_distance"].get<double>());
  }
}

}  // namespace greenloop::offline
