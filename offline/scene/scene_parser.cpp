// From text to Scene, with every problem collected on the way.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "formats/write/describe.hpp"
#include "offline/scene/scene.hpp"
#include "offline/scene/simulation_parser.hpp"
#include "offline/scene/toml_source.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {
namespace {

/// "auto", a length, or 0.
void read_weld(const Table& table, MeshSource& mesh) {
  const auto* node = table.find("weld");
  if (node == nullptr || node->value<std::string>() == "auto") {
    return;
  }
  const bool zero = node->is_number() && *node->value<double>() == 0;
  mesh.weld = zero ? std::optional<double>(0) : table.quantity("weld", Dimension::length);
}

/// "auto" or a length, and which piece.
void read_wrap(const Table& table, MeshSource& mesh) {
  const auto* node = table.find("wrap");
  if (node != nullptr) {
    mesh.wrap.emplace();
    if (node->value<std::string>() != "auto") mesh.wrap->length = table.quantity("wrap", Dimension::length);
  }
  const auto pieces = table.string("pieces");
  if (pieces && *pieces != "one" && *pieces != "largest") {
    table.refuse("pieces", "\"" + *pieces + "\" is neither \"one\", which refuses several, nor \"largest\"");
  } else if (table.has("pieces") && !mesh.wrap) {
    table.refuse("pieces", "chooses among the pieces of a wrap; write wrap = \"auto\" beside it");
  } else if (pieces) {
    mesh.wrap->largest_piece = *pieces == "largest";
  }
  if (mesh.wrap && table.has("weld")) {
    table.refuse("weld", "does not go with wrap, which closes seams by itself; remove one of them");
  }
  for (const std::string_view key : {"wrap", "pieces"}) {
    if (mesh.tetrahedra && table.has(key)) {
      table.refuse(key,
                   "does not go with [volume], whose tetrahedra are used as they are; remove it, or name the file in "
                   "[surface], which takes their boundary");
    }
  }
}

void read_mesh(const Table& scene, const std::filesystem::path& file, MeshSource& mesh) {
  if (scene.has("surface") == scene.has("volume")) {
    scene.problems().add({}, scene.has("volume") ? "volume" : "surface",
                         scene.has("volume")
                             ? "the scene has [surface] and [volume]; keep one of them"
                             : "missing; write for example [surface] file = \"bear.off\", unit = \"cm\"");
  }
  for (const std::string_view name : {"surface", "volume"}) {
    const auto table =
        section(scene, name, {"file", "unit", "size", "weld", "wrap", "pieces", "cavities", "keep_vertex_map"});
    if (!table) {
      continue;
    }
    mesh.tetrahedra = name == "volume";
    table->require("file", mesh.tetrahedra ? "file = \"liver.msh\"" : "file = \"bear.off\"");
    set_if(mesh.name, table->string("file"));
    mesh.path = beside(file, mesh.name);
    mesh.unit = table->quantity("unit", Dimension::length);
    mesh.size = table->quantity("size", Dimension::length);
    read_weld(*table, mesh);
    if (mesh.tetrahedra && table->has("weld")) {
      table->refuse("weld", "does not go with [volume], whose tetrahedra share their vertices; remove it");
    }
    read_wrap(*table, mesh);
    set_if(mesh.cavities, table->boolean("cavities"));
    if (mesh.tetrahedra && table->has("cavities")) {
      table->refuse("cavities", "does not go with [volume], whose tetrahedra have their cavities; remove it");
    } else if (mesh.wrap && mesh.cavities) {
      table->refuse("cavities", "does not go with wrap, which fills them; remove one of them");
    }
    set_if(mesh.keep_vertex_map, table->boolean("keep_vertex_map"));
    if (mesh.tetrahedra && table->has("keep_vertex_map")) {
      table->refuse("keep_vertex_map", "does not go with [volume], whose surface is not the author's; remove it");
    }
    if (!table->has("unit") && !table->has("size")) {
      table->refuse("unit",
                    "missing; say how long one unit of the mesh is, for example unit = \"cm\", or how long the "
                    "longest side of its bounding box shall be, for example size = \"30 cm\"");
    } else if (table->has("unit") && table->has("size")) {
      table->refuse("size", "unit and size contradict each other; keep one of them");
    }
  }
}

void read_remesh(const Table& scene, bool tetrahedra, Remesh& remesh) {
  const auto table = section(scene, "remesh", {"base_vertices", "levels"});
  if (!table) {
    return;
  }
  set_if(remesh.base_vertices, table->integer("base_vertices", 4, 10000));
  set_if(remesh.levels, table->integer("levels", 0, most_levels));
  if (tetrahedra && table->has("base_vertices")) {
    table->refuse("base_vertices", "does not go with [volume], whose boundary vertices are kept; remove it");
  }
}

void read_material(const Table& scene, Material& material, std::optional<double>& density) {
  if (!scene.has("material")) {
    scene.problems().add({}, "material", "missing; write for example [material] young = \"20 kPa\", poisson = 0.4");
  }
  const auto table = section(scene, "material", {"young", "poisson", "density"});
  if (!table) {
    return;
  }
  table->require("young", "young = \"20 kPa\"");
  table->require("poisson", "poisson = 0.4");
  set_if(material.young, table->quantity("young", Dimension::pressure));
  set_if(material.poisson, table->number("poisson", {-1, 0.5, true, true}));
  density = table->quantity("density", Dimension::density);
}

void read_solve(const Table& scene, Elements& elements) {
  const auto table = section(scene, "solve", {"elements"});
  const auto name = table ? table->string("elements") : std::nullopt;
  if (!name) {
    return;
  }
  if (*name != "linear" && *name != "quadratic") {
    table->refuse("elements", '"' + *name + "\" are no elements; there are \"linear\", \"quadratic\"");
  }
  elements = *name == "quadratic" ? Elements::quadratic : Elements::linear;
}

std::optional<Region> read_half_space(const Table& table, bool below) {
  const auto level = table.number(below ? "below" : "above", fraction);
  table.require("axis", "axis = \"y\"");
  const auto axis = table.string("axis");
  if (axis && *axis != "x" && *axis != "y" && *axis != "z") {
    table.refuse("axis", "\"" + *axis + "\" is no axis; expected \"x\", \"y\" or \"z\"");
    return std::nullopt;
  }
  if (!level || !axis) {
    return std::nullopt;
  }
  return HalfSpace{(*axis)[0] - 'x', below, *level};
}

std::optional<Region> read_box(const Table& table) {
  const auto* corners = table.find("box")->as_array();
  if (corners == nullptr || corners->size() != 2) {
    table.refuse("box", "expected two corners, such as [[0, 0, 0], [1, 0.5, 1]]");
    return std::nullopt;
  }
  const auto low = table.fractions("box", (*corners)[0]);
  const auto high = low ? table.fractions("box", (*corners)[1]) : std::nullopt;
  if (high && (low->array() > high->array()).any()) {
    table.refuse("box", "the first corner has to be the lower one on every axis");
    return std::nullopt;
  }
  return high ? std::optional<Region>(BoxRegion{*low, *high}) : std::nullopt;
}

std::optional<Region> read_sphere(const Table& parent) {
  const auto table = section(parent, "sphere", {"center", "radius"});
  if (!table) {
    return std::nullopt;
  }
  table->require("center", "center = [0.5, 1, 0.5]");
  table->require("radius", "radius = 0.2 (of the longest side of the bounding box) or \"2 cm\"");
  const auto center = table->fractions("center");
  const bool metres = table->has("radius") && table->find("radius")->is_string();
  const auto radius = metres ? table->quantity("radius", Dimension::length) : table->number("radius", {0, 1, true});
  return center && radius ? std::optional<Region>(SphereRegion{*center, *radius, metres}) : std::nullopt;
}

std::optional<Region> read_nearest(const Table& table) {
  NearestRegion region{};
  const auto point = table.fractions("near");
  set_if(region.count, table.integer("count", 1, 1000000));
  if (!point) {
    return std::nullopt;
  }
  region.point = *point;
  return region;
}

/// A region is one shape; axis and count belong to some of them.
std::optional<Region> read_region(const Table& table) {
  constexpr std::array<std::string_view, 5> shapes{"below", "above", "box", "sphere", "near"};
  std::vector<std::string_view> given;
  std::copy_if(shapes.begin(), shapes.end(), std::back_inserter(given), [&](auto shape) { return table.has(shape); });
  if (given.size() != 1) {
    table.refuse_table((given.empty() ? "no shape" : "several shapes (" + comma_list(given) + ")") +
                       "; a region is exactly one of " + comma_list(shapes));
    return std::nullopt;
  }
  const bool half_space = given[0] == "below" || given[0] == "above";
  for (const auto& [key, goes] : {std::pair{"axis", half_space}, std::pair{"count", given[0] == "near"}}) {
    if (table.has(key) && !goes) {
      table.refuse(key, "does not go with " + std::string(given[0]) + "; remove it");
    }
  }
  if (half_space) {
    return read_half_space(table, given[0] == "below");
  }
  return given[0] == "box" ? read_box(table) : given[0] == "sphere" ? read_sphere(table) : read_nearest(table);
}

/// Calls read(table) for each of the tables [[role]].
template <class Read>
void read_tables(const Table& scene, std::string_view role, const std::string& example,
                 std::initializer_list<std::string_view> valid, const Read& read) {
  const auto* node = scene.find(role);
  if (node == nullptr) {
    return;
  }
  const auto* array = node->as_array();
  const bool tables = array != nullptr && !array->empty() &&
                      std::all_of(array->begin(), array->end(), [](const toml::node& item) { return item.is_table(); });
  if (!tables) {
    scene.refuse(role, "is " + std::string(kind_of(*node)) + "; expected one or more tables [[" + std::string(role) +
                           "]], such as [[" + std::string(role) + "]] " + example);
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    read(Table(*(*array)[i].as_table(), std::string(role) + "[" + std::to_string(i) + "]", valid, scene.problems()));
  }
}

void read_regions(const Table& scene, std::string_view role, std::vector<Region>& regions) {
  read_tables(scene, role, "below = 0.1, axis = \"y\"", {"below", "above", "axis", "box", "sphere", "near", "count"},
              [&](const Table& table) {
                if (auto region = read_region(table)) regions.push_back(std::move(*region));
              });
}

void read_gravity(const Table& table, const std::optional<double>& density, bool& gravity) {
  if (table.toml().size() > 1) {
    table.refuse("gravity", "acts on the whole body; write it in a table [[loads]] of its own");
  }
  set_if(gravity, table.boolean("gravity"));
  if (gravity && !density) {
    table.refuse("gravity", "needs the body's mass: write for example [material] density = \"1000 kg/m^3\"");
  }
}

void read_load_name(const Table& table, const std::vector<PressureLoad>& others, std::string& name) {
  table.require("name", "name = \"palm\"");
  set_if(name, table.string("name"));
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!printable || name.size() > longest_load_name) {
    table.refuse("name", "has to be of at most " + std::to_string(longest_load_name) + " printable ASCII letters");
  } else if (std::any_of(others.begin(), others.end(), [&](const PressureLoad& other) { return other.name == name; })) {
    table.refuse("name", "\"" + name + "\" is another load's name already");
  }
}

void read_pressure(const Table& table, std::vector<PressureLoad>& pressures) {
  PressureLoad load;
  read_load_name(table, pressures, load.name);
  const auto* direction = table.find("direction");
  if (direction != nullptr && direction->value<std::string>() != "normal")
    load.direction = table.direction("direction");
  auto region = read_region(table);
  set_if(load.mask, table.boolean("mask"));
  if (load.mask && region && !std::holds_alternative<SphereRegion>(*region)) {
    table.refuse("mask", "goes with a sphere, the mask's vertex is the one nearest to its center");
  }
  if (pressures.size() == most_pressures) {
    table.refuse_table("there are at most " + std::to_string(most_pressures) + " pressures");
  } else if (region) {
    load.region = std::move(*region);
    pressures.push_back(std::move(load));
  }
}

/// Gravity, or the pressure on a region.
void read_loads(const Table& scene, Scene& result) {
  read_tables(scene, "loads", "gravity = true",
              {"gravity", "name", "direction", "mask", "below", "above", "axis", "box", "sphere", "near", "count"},
              [&](const Table& table) {
                table.has("gravity") ? read_gravity(table, result.density, result.gravity)
                                     : read_pressure(table, result.pressures);
              });
}

void read_constraints(const Table& scene, int levels, int& coarsest) {
  const auto table = section(scene, "constraints", {"coarsest"});
  if (!table) {
    return;
  }
  if (const auto value = table->integer("coarsest", 0, most_levels)) {
    coarsest = static_cast<int>(*value);
    if (coarsest > levels) {
      table->refuse("coarsest", std::to_string(coarsest) + " is finer than the finest level; remesh.levels is " +
                                    std::to_string(levels));
    }
  }
}

void read_accuracy(const Table& scene, AccuracyGoal& accuracy) {
  constexpr Interval error{0, 1, true, true};
  constexpr Interval error_of_pattern{0, 10, true, true};
  if (const auto table =
          section(scene, "accuracy",
                  {"rms", "worst_column", "patch_force", "field", "field_peak", "field_rough", "mesh_error"})) {
    set_if(accuracy.rms, table->number("rms", error));
    set_if(accuracy.worst_column, table->number("worst_column", error));
    set_if(accuracy.patch_force, table->number("patch_force", error_of_pattern));
    set_if(accuracy.field, table->number("field", error_of_pattern));
    set_if(accuracy.field_peak, table->number("field_peak", error_of_pattern));
    set_if(accuracy.field_rough, table->number("field_rough", error_of_pattern));
    accuracy.mesh_error = table->number("mesh_error", error_of_pattern);
  }
}

void read_compression(const Table& scene, std::optional<layout::Wavelet>& wavelet, bool& ready) {
  const auto table = section(scene, "compression", {"wavelet", "ready"});
  if (table) set_if(ready, table->boolean("ready"));
  const auto name = table ? table->string("wavelet") : std::nullopt;
  if (!name || *name == "auto") {
    return;
  }
  std::string names = "\"auto\"";
  for (const layout::Wavelet known : layout::wavelets) {
    const std::string known_name(wavelet_name(static_cast<std::uint32_t>(known)));
    if (*name == known_name) {
      wavelet = known;
      return;
    }
    names += ", \"" + known_name + "\"";
  }
  table->refuse("wavelet", "\"" + *name + "\" is no wavelet; there are " + names);
}

void read_budget(const Table& scene, StepBudget& budget) {
  const auto table = section(scene, "budget", {"rate", "share", "work", "units_per_us", "contacts"});
  if (!table) {
    return;
  }
  set_if(budget.rate, table->quantity("rate", Dimension::frequency));
  budget.share = table->number("share", {0, 1, true});
  budget.work = table->integer("work", 1, most_work);
  budget.units_per_us = table->number("units_per_us", positive);
  set_if(budget.contacts, table->integer("contacts", 1, 4096));
  if (table->has("units_per_us") && table->has("work")) {
    table->refuse("units_per_us", "work and units_per_us contradict each other; keep one of them");
  } else if (table->has("units_per_us") && !table->has("share")) {
    table->refuse("units_per_us",
                  "says how much work a share of the period holds; write for example share = 0.4 beside it");
  }
  if (budget.share && !budget.work && budget.step_us() * budget.speed() > static_cast<double>(most_work)) {
    table->refuse("share", "of this period is more than 10^12 work units; raise rate, or lower units_per_us");
  }
}

void read_store(const Table& scene, const std::filesystem::path& file, Scene& result) {
  if (const auto table = section(scene, "store", {"file"})) {
    table->require("file", "file = \"bear.h5\"");
    if (const auto name = table->string("file")) {
      result.store_name = *name;
      result.store = beside(file, *name);
    }
  }
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  Problems problems(file.string());
  const Table table(toml, "", {"surface",      "volume",    "remesh",     "material",    "solve",    "fixed",
                               "touched",      "read",      "loads",      "constraints", "accuracy", "compression",
                               "budget",       "store",     "simulate",   "impulses",    "sheet",    "rigid",
                               "trajectories", "reduction", "appearance", "multigrid"},
                    problems);
  Scene scene;
  read_mesh(table, file, scene.mesh);
  read_remesh(table, scene.mesh.tetrahedra, scene.remesh);
  if (!table.has("sheet")) read_material(table, scene.material, scene.density);
  read_solve(table, scene.elements);
  if (!table.has("fixed")) {
    problems.add({}, "fixed",
                 "missing; something has to hold the body: write for example [[fixed]] below = 0.1, axis = \"y\"");
  }
  read_regions(table, "fixed", scene.fixed);
  read_regions(table, "touched", scene.touched);
  read_regions(table, "read", scene.read);
  read_loads(table, scene);
  read_constraints(table, scene.remesh.levels, scene.coarsest_constraints);
  // what a model of trajectories is to be like says its own reader
  if (!table.has("trajectories")) read_accuracy(table, scene.accuracy);
  read_compression(table, scene.wavelet, scene.ready);
  read_budget(table, scene.budget);
  read_store(table, file, scene);
  read_simulation(table, file, scene);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::filesystem::path& file) { return parse_scene(scene_file_text(file), file); }

}  // namespace greenloop::offline
