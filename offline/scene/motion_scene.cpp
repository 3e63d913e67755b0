#include "offline/scene/motion_scene.hpp"

#include "offline/scene/sheet_parser.hpp"
#include "offline/scene/toml_source.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {
namespace {

constexpr Interval error{0, 1, true, true};
constexpr std::int64_t least_megabytes = 64, most_megabytes = 1 << 20;

void read_trajectories(const Table& scene, const std::filesystem::path& file, MotionScene& result) {
  const auto table = section(scene, "trajectories", {"file"});
  if (!table) return;
  table->require("file", "file = \"cloth.h5\"");
  set_if(result.name, table->string("file"));
  result.trajectories = beside(file, result.name);
}

void read_accuracy(const Table& scene, MotionScene& result) {
  const auto table = section(scene, "accuracy", {"truncation", "quantisation"});
  if (!table) return;
  set_if(result.truncation, table->number("truncation", error));
  set_if(result.quantisation, table->number("quantisation", error));
}

void read_reduction(const Table& scene, MotionScene& result) {
  const auto table = section(scene, "reduction", {"dead_end", "blend_rate", "memory"});
  if (!table) return;
  set_if(result.dead_end, table->number("dead_end", {0, 10, true}));
  result.blend_rate = table->number("blend_rate", {0, 1e6, true});
  if (const auto megabytes = table->integer("memory", least_megabytes, most_megabytes)) {
    result.memory = static_cast<std::size_t>(*megabytes) << 20U;
  }
}

void read_budget(const Table& scene, MotionScene& result) {
  if (const auto table = section(scene, "budget", {"rate"}))
    result.rate = table->quantity("rate", Dimension::frequency);
}

}  // namespace

std::optional<MotionScene> parse_motion_scene(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  if (!toml.contains("trajectories")) return std::nullopt;
  Problems problems(file.string());
  // what `greenloop simulate` reads may stand in the same file
  const Table table(toml, "",
                    {"trajectories", "accuracy", "reduction", "budget", "surface", "remesh", "material", "fixed",
                     "simulate", "impulses", "sheet", "rigid"},
                    problems);
  MotionScene scene;
  read_trajectories(table, file, scene);
  read_accuracy(table, scene);
  read_reduction(table, scene);
  read_budget(table, scene);
  scene.sheet = read_sheet(table);
  problems.throw_if_any();
  return scene;
}

std::optional<MotionScene> read_motion_scene(const std::filesystem::path& file) {
  return parse_motion_scene(scene_file_text(file), file);
}

std::string canonical_text(const MotionScene& scene) {
  std::string text = "[trajectories]\nfile = \"" + scene.name + "\"\n";
  text += "[accuracy]\ntruncation = " + shortest(scene.truncation) + "\nquantisation = " + shortest(scene.quantisation);
  text += "\n[reduction]\ndead_end = " + shortest(scene.dead_end) + "\nmemory = " + std::to_string(scene.memory >> 20U);
  if (scene.blend_rate) text += "\nblend_rate = " + shortest(*scene.blend_rate);
  if (scene.rate) text += "\n[budget]\nrate = \"" + shortest(*scene.rate) + " Hz\"";
  return text + "\n";
}

}  // namespace greenloop::offline
