#include "offline/scene/motion_scene.hpp"

#include "formats/layout.hpp"
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

std::optional<Eigen::Vector3d> read_reflectance(const Table& table) {
  const auto* node = table.find("reflectance");
  if (node == nullptr) return std::nullopt;
  const auto* array = node->as_array();
  Eigen::Vector3d result = Eigen::Vector3d::Constant(-1);
  for (std::size_t i = 0; array != nullptr && array->size() == 3 && i < 3; ++i)
    result[static_cast<Eigen::Index>(i)] = (*array)[i].value<double>().value_or(-1);
  if (result.array().isNaN().any() || result.minCoeff() < 0 || result.maxCoeff() > 1) {
    table.refuse("reflectance", "expected red, green and blue from 0 to 1, such as [0.8, 0.4, 0.3]");
    return std::nullopt;
  }
  return result;
}

void read_part(const Table& table, std::vector<PaintedPart>& parts) {
  table.require("box", "box = [[0, 0, 0], [1, 0.5, 1]]");
  table.require("reflectance", "reflectance = [0.8, 0.4, 0.3]");
  const auto* box = table.has("box") ? table.find("box")->as_array() : nullptr;
  const auto reflectance = read_reflectance(table);
  if (box == nullptr || box->size() != 2) {
    if (table.has("box")) table.refuse("box", "expected two corners, such as [[0, 0, 0], [1, 0.5, 1]]");
    return;
  }
  const auto low = table.fractions("box", (*box)[0]), high = table.fractions("box", (*box)[1]);
  if (low && high && reflectance) parts.push_back({{*low, *high}, *reflectance});
}

void read_parts(const Table& appearance, std::vector<PaintedPart>& parts) {
  const auto* node = appearance.find("parts");
  if (node == nullptr) return;
  const auto* array = node->as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const auto* part = (*array)[i].as_table();
    const std::string name = "appearance.parts[" + std::to_string(i) + "]";
    if (part != nullptr) read_part(Table(*part, name, {"box", "reflectance"}, appearance.problems()), parts);
  }
  if (array == nullptr || !array->is_array_of_tables())
    appearance.refuse("parts", "expected tables [[appearance.parts]] with a box and a reflectance");
}

void read_appearance(const Table& scene, MotionScene& result) {
  constexpr std::int64_t most_states = 4096, most_rays = 1 << 16, most_bounces = 4096;
  const auto table =
      section(scene, "appearance", {"reflectance", "parts", "error", "rank", "states", "rays", "bounces"});
  if (!table) return;
  AppearanceScene& appearance = result.appearance.emplace();
  set_if(appearance.reflectance, read_reflectance(*table));
  read_parts(*table, appearance.parts);
  set_if(appearance.error, table->number("error", error));
  set_if(appearance.rank, table->integer("rank", 1, layout::most_transfer_modes));
  set_if(appearance.states, table->integer("states", 3, most_states));
  set_if(appearance.rays, table->integer("rays", 16, most_rays));
  set_if(appearance.bounces, table->integer("bounces", 0, most_bounces));
}

std::string triple(const Eigen::Vector3d& of) {
  return std::string("[") + shortest(of.x()) + ", " + shortest(of.y()) + ", " + shortest(of.z()) + "]";
}

std::string appearance_text(const AppearanceScene& appearance) {
  std::string text = "\n[appearance]\nreflectance = " + triple(appearance.reflectance) +
                     "\nerror = " + shortest(appearance.error) + "\nrank = " + std::to_string(appearance.rank) +
                     "\nstates = " + std::to_string(appearance.states) + "\nrays = " + std::to_string(appearance.rays) +
                     "\nbounces = " + std::to_string(appearance.bounces);
  for (const PaintedPart& part : appearance.parts) {
    text += "\n[[appearance.parts]]\nbox = [" + triple(part.box.low) + ", " + triple(part.box.high) +
            "]\nreflectance = " + triple(part.reflectance);
  }
  return text;
}

}  // namespace

std::optional<MotionScene> parse_motion_scene(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  if (!toml.contains("trajectories")) return std::nullopt;
  Problems problems(file.string());
  // what `greenloop simulate` reads may stand in the same file
  const Table table(toml, "",
                    {"trajectories", "accuracy", "reduction", "budget", "appearance", "surface", "remesh", "material",
                     "fixed", "simulate", "impulses", "sheet", "rigid"},
                    problems);
  MotionScene scene;
  read_trajectories(table, file, scene);
  read_accuracy(table, scene);
  read_reduction(table, scene);
  read_budget(table, scene);
  read_appearance(table, scene);
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
  if (scene.appearance) text += appearance_text(*scene.appearance);
  return text + "\n";
}

}  // namespace greenloop::offline
