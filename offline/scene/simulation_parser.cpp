#include "offline/scene/simulation_parser.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "offline/scene/sheet_parser.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t longest_impulse_name = 31;

void read_name(const Table& table, const std::vector<SupportImpulse>& others, std::string& name) {
  table.require("name", "name = \"braking\"");
  set_if(name, table.string("name"));
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!printable || name.size() > longest_impulse_name || name == "rest") {
    table.refuse("name", "has to be of at most " + std::to_string(longest_impulse_name) +
                             " printable ASCII letters, and not \"rest\"");
  } else if (std::any_of(others.begin(), others.end(), [&](const auto& other) { return other.name == name; })) {
    table.refuse("name", "\"" + name + "\" is another impulse's name already");
  }
}

std::optional<std::vector<std::string>> read_after(const Table& table) {
  const auto* node = table.find("after");
  if (node == nullptr) return std::nullopt;
  const auto* array = node->as_array();
  const bool strings = array != nullptr && std::all_of(array->begin(), array->end(),
                                                       [](const toml::node& item) { return item.is_string(); });
  std::vector<std::string> names;
  if (!strings) {
    table.refuse("after", "expected names of impulses, such as [\"rest\", \"braking\"]");
    return names;
  }
  for (const auto& item : *array) names.push_back(*item.value<std::string>());
  return names;
}

void read_impulse(const Table& table, bool sheets, std::vector<SupportImpulse>& impulses) {
  SupportImpulse impulse;
  read_name(table, impulses, impulse.name);
  impulse.longest = table.quantity("longest", Dimension::time);
  set_if(impulse.turning, table.number("turning", {}));
  const bool pushes = table.has("velocity") || table.has("direction");
  if (pushes || (!sheets && !table.has("turning"))) {
    table.require("velocity", "velocity = \"0.5 m/s\"");
    table.require("direction", "direction = [1, 0, 0]");
  }
  if (table.has("turning") && !sheets) table.refuse("turning", "goes with [sheet] only");
  if (table.has("turning") && pushes) table.refuse("turning", "does not go with velocity and direction");
  set_if(impulse.speed, table.quantity("velocity", Dimension::speed));
  if (table.has("direction")) impulse.direction = table.direction("direction").value_or(Eigen::Vector3d::UnitX());
  impulse.after = read_after(table);
  impulses.push_back(std::move(impulse));
}

void read_impulses(const Table& scene, std::vector<SupportImpulse>& impulses) {
  const auto* node = scene.find("impulses");
  const auto* array = node != nullptr ? node->as_array() : nullptr;
  const bool tables = array != nullptr && !array->empty() && array->size() <= 64 &&
                      std::all_of(array->begin(), array->end(), [](const toml::node& item) { return item.is_table(); });
  if (!tables) {
    scene.refuse("impulses",
                 "expected 1 to 64 tables [[impulses]], such as [[impulses]] name = \"braking\", velocity = \"0.5 "
                 "m/s\", direction = [1, 0, 0]");
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    read_impulse(Table(*(*array)[i].as_table(), "impulses[" + std::to_string(i) + "]",
                       {"name", "velocity", "direction", "turning", "longest", "after"}, scene.problems()),
                 scene.has("sheet"), impulses);
  }
}

void require_known_successions(const Table& scene, const std::vector<SupportImpulse>& impulses) {
  const auto known = [&](const std::string& name) {
    return name == "rest" ||
           std::any_of(impulses.begin(), impulses.end(), [&](const auto& impulse) { return impulse.name == name; });
  };
  bool begins = false;
  for (const auto& impulse : impulses) {
    begins = begins || !impulse.after;
    for (const auto& name : impulse.after.value_or(std::vector<std::string>())) {
      begins = begins || name == "rest";
      if (!known(name)) scene.refuse("impulses", "\"" + impulse.name + "\" is to follow the unknown \"" + name + "\"");
    }
  }
  if (!begins && !impulses.empty()) scene.refuse("impulses", "none may follow \"rest\"");
}

void read_durations(const Table& table, Simulation& simulation) {
  table.require("shortest", "shortest = \"0.3 s\"");
  table.require("longest", "longest = \"1.5 s\"");
  set_if(simulation.shortest, table.quantity("shortest", Dimension::time));
  set_if(simulation.longest, table.quantity("longest", Dimension::time));
  set_if(simulation.to_rest, table.number("to_rest", fraction));
  simulation.longest_to_rest = 4 * simulation.longest;
  set_if(simulation.longest_to_rest, table.quantity("longest_to_rest", Dimension::time));
  if (simulation.longest < simulation.shortest) table.refuse("longest", "is shorter than shortest");
  if (simulation.longest_to_rest < simulation.longest) table.refuse("longest_to_rest", "is shorter than longest");
}

void read_trajectories(const Table& scene, const std::filesystem::path& file, Simulation& simulation) {
  const auto table = section(scene, "trajectories", {"file"});
  if (!table) return;
  table->require("file", "file = \"rubber.h5\"");
  set_if(simulation.trajectories_name, table->string("file"));
  simulation.trajectories = (file.parent_path() / simulation.trajectories_name).lexically_normal();
}

/// One of two words; true: the first.
void read_choice(const Table& table, std::string_view key, const std::string& first, const std::string& second,
                 bool& is_first) {
  const auto word = table.string(key);
  if (word && *word != first && *word != second) {
    table.refuse(key, "\"" + *word + "\" is neither \"" + first + "\" nor \"" + second + "\"");
  }
  if (word) is_first = *word == first;
}

void read_motion(const Table& table, int levels, Simulation& simulation) {
  table.require("time_step", "time_step = \"10 ms\"");
  table.require("rest", "rest = \"0.1 mm\"");
  set_if(simulation.time_step, table.quantity("time_step", Dimension::time));
  set_if(simulation.rest, table.quantity("rest", Dimension::length));
  set_if(simulation.mass_damping, table.quantity("mass_damping", Dimension::rate));
  set_if(simulation.stiffness_damping, table.quantity("stiffness_damping", Dimension::time));
  set_if(simulation.newmark_gamma, table.number("newmark_gamma", {0.5, 1}));
  read_choice(table, "strain", "corotational", "linear", simulation.corotational);
  simulation.level = levels;
  set_if(simulation.level, table.integer("level", 0, most_levels));
  if (simulation.level > levels) {
    table.refuse("level", "is finer than the finest level; remesh.levels is " + std::to_string(levels));
  }
}

void read_sampling(const Table& table, Simulation& simulation) {
  table.require("orbits", "orbits = 200");
  set_if(simulation.orbits, table.integer("orbits", 1, most_orbits));
  set_if(simulation.held_out, table.integer("held_out", 0, most_orbits));
  set_if(simulation.seed, table.integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
  read_choice(table, "sampling", "coverage", "random", simulation.coverage);
  set_if(simulation.replay_goal, table.number("replay_goal", {0, 1, true}));
  if (simulation.replay_goal > 0 && simulation.held_out == 0) table.refuse("replay_goal", "needs held_out orbits");
}

void refuse_keys_of_solids(const Table& simulate) {
  for (const std::string_view key : {"strain", "level", "mass_damping", "stiffness_damping", "newmark_gamma"}) {
    if (simulate.has(key)) simulate.refuse(key, "is of elastic solids, not of sheets");
  }
}

}  // namespace

std::vector<std::uint8_t> successions(const Simulation& simulation) {
  const auto& impulses = simulation.impulses;
  std::vector<std::uint8_t> table((impulses.size() + 1) * impulses.size(), 0);
  for (std::size_t row = 0; row <= impulses.size(); ++row) {
    const std::string& before = row < impulses.size() ? impulses[row].name : "rest";
    for (std::size_t i = 0; i < impulses.size(); ++i) {
      const auto& after = impulses[i].after;
      const bool may = !after || std::find(after->begin(), after->end(), before) != after->end();
      table[row * impulses.size() + i] = may ? 1 : 0;
    }
  }
  return table;
}

void read_simulation(const Table& table, const std::filesystem::path& file, Scene& scene) {
  const auto simulate =
      section(table, "simulate",
              {"time_step", "strain", "level", "mass_damping", "stiffness_damping", "newmark_gamma", "rest", "sampling",
               "orbits", "held_out", "shortest", "longest", "to_rest", "longest_to_rest", "seed", "replay_goal"});
  if (!simulate) {
    for (const std::string_view key : {"impulses", "trajectories", "appearance", "sheet", "rigid"}) {
      if (table.has(key)) table.refuse(key, "belong to a [simulate] section, which is missing");
    }
    return;
  }
  Simulation simulation;
  read_motion(*simulate, scene.remesh.levels, simulation);
  read_durations(*simulate, simulation);
  read_sampling(*simulate, simulation);
  read_trajectories(table, file, simulation);
  read_impulses(table, simulation.impulses);
  require_known_successions(table, simulation.impulses);
  simulation.sheet = read_sheet(table);
  if (simulation.sheet) {
    refuse_keys_of_solids(*simulate);
    table.require("trajectories", "[trajectories] file = \"cloth.h5\"");
  } else if (!scene.density) {
    simulate->refuse_table("needs the body's mass: write for example [material] density = \"1000 kg/m^3\"");
  }
  if (scene.mesh.tetrahedra) {
    simulate->refuse_table("goes with [surface], whose inside it fills with tetrahedra");
  }
  scene.simulation = std::move(simulation);
}

}  // namespace greenloop::offline
