// The only file that sees the TOML library: from text to Scene, with every problem collected on the way.
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <utility>

#include "offline/scene/scene.hpp"
#include "offline/scene/spelling.hpp"
#include "offline/scene/units.hpp"

namespace greenloop::offline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

/// What is wrong with a scene, each with its place.
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}

  void add(const toml::source_position& where, const std::string& key, const std::string& reason) {
    found_.push_back({where.line, where.column, key, reason});
  }

  void throw_if_any() {
    if (found_.empty()) {
      return;
    }
    std::stable_sort(found_.begin(), found_.end(), [](const Problem& a, const Problem& b) {
      return std::tuple(a.line, a.column) < std::tuple(b.line, b.column);
    });
    std::vector<std::string> lines;
    for (const auto& problem : found_) {
      std::string line = file_;
      if (problem.line != 0) {
        line.append(":").append(std::to_string(problem.line)).append(":").append(std::to_string(problem.column));
      }
      lines.push_back(line + ": " + (problem.key.empty() ? "" : problem.key + ": ") + problem.reason);
    }
    throw SceneError(std::move(lines));
  }

 private:
  struct Problem {
    toml::source_index line;
    toml::source_index column;
    std::string key;
    std::string reason;
  };

  std::string file_;
  std::vector<Problem> found_;
};

std::string_view kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number with a fraction";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

/// The numbers a key accepts; open ends are excluded.
struct Interval {
  double low = -infinity;
  double high = infinity;
  bool low_open = false;
  bool high_open = false;

  [[nodiscard]] bool contains(double value) const {
    return std::isfinite(value) && (low_open ? value > low : value >= low) &&
           (high_open ? value < high : value <= high);
  }

  [[nodiscard]] std::string text() const {
    const auto from = (low_open ? "greater than " : "at least ") + shortest(low);
    const auto to = (high_open ? "less than " : "at most ") + shortest(high);
    return std::isinf(high) ? from : from + " and " + to;
  }
};

constexpr Interval fraction{0, 1};
constexpr Interval positive{0, infinity, true};

/// One table of the scene; refuses keys it does not know.
class Table {
 public:
  Table(const toml::table& table, std::string name, std::initializer_list<std::string_view> valid, Problems& problems)
      : table_(table), name_(std::move(name)), problems_(problems) {
    const std::vector<std::string_view> keys(valid);
    for (const auto& [key, node] : table_) {
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) {
        problems_.add(key.source().begin, full(key.str()),
                      "unknown key" + did_you_mean(key.str(), keys) + "; valid here: " + comma_list(keys));
      }
    }
  }

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  [[nodiscard]] const toml::node* find(std::string_view key) const { return table_.get(key); }
  [[nodiscard]] const toml::table& toml() const { return table_; }
  [[nodiscard]] Problems& problems() const { return problems_; }
  [[nodiscard]] std::string full(std::string_view key) const {
    return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  }

  void refuse(std::string_view key, const std::string& reason) const {
    const auto* node = find(key);
    problems_.add(node != nullptr ? node->source().begin : table_.source().begin, full(key), reason);
  }
  void refuse_table(const std::string& reason) const { problems_.add(table_.source().begin, name_, reason); }

  void require(std::string_view key, const std::string& example) const {
    if (!has(key)) {
      refuse(key, "missing; write for example " + example);
    }
  }

  [[nodiscard]] std::optional<std::string> string(std::string_view key) const {
    const auto* node = find(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    auto value = node->is_string() ? node->value<std::string>() : std::nullopt;
    if (!value) {
      refuse(key, "is " + std::string(kind_of(*node)) + "; expected a string");
    } else if (value->empty()) {
      refuse(key, "is empty");
      return std::nullopt;
    }
    return value;
  }

  [[nodiscard]] std::optional<double> number(std::string_view key, const Interval& valid) const {
    const auto* node = find(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    if (!node->is_number()) {
      refuse(key, "is " + std::string(kind_of(*node)) + "; expected a number " + valid.text());
      return std::nullopt;
    }
    const double value = *node->value<double>();
    if (!valid.contains(value)) {
      refuse(key, shortest(value) + " is out of range; it has to be " + valid.text());
      return std::nullopt;
    }
    return value;
  }

  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key, std::int64_t low, std::int64_t high) const {
    const auto* node = find(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    const auto range = "from " + std::to_string(low) + " to " + std::to_string(high);
    if (!node->is_integer()) {
      refuse(key, "is " + std::string(kind_of(*node)) + "; expected a whole number " + range);
      return std::nullopt;
    }
    const auto value = *node->value<std::int64_t>();
    if (value < low || value > high) {
      refuse(key, std::to_string(value) + " is out of range; it has to be " + range);
      return std::nullopt;
    }
    return value;
  }

  /// A string with a number and a unit, in SI; greater than zero.
  [[nodiscard]] std::optional<double> quantity(std::string_view key, Dimension dimension) const {
    const auto* node = find(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    const auto example = "write for example \"" + std::string(example_of(dimension)) + "\"";
    if (node->is_number()) {
      refuse(key, shortest(*node->value<double>()) + " has no unit; " + example);
      return std::nullopt;
    }
    const auto text = string(key);
    if (!text) {
      return std::nullopt;
    }
    try {
      const bool unit_alone = key == "unit" && std::isalpha(static_cast<unsigned char>(text->front())) != 0;
      const double value = unit_alone ? parse_unit(*text, dimension) : parse_quantity(*text, dimension);
      if (value > 0) {
        return value;
      }
      refuse(key, "\"" + *text + "\" has to be greater than zero");
    } catch (const UnitError& error) {
      refuse(key, error.what());
    }
    return std::nullopt;
  }

  /// Three fractions of the bounding box.
  [[nodiscard]] std::optional<Eigen::Vector3d> fractions(std::string_view key) const {
    const auto* node = find(key);
    return node == nullptr ? std::nullopt : fractions(key, *node);
  }

  [[nodiscard]] std::optional<Eigen::Vector3d> fractions(std::string_view key, const toml::node& node) const {
    const auto* array = node.as_array();
    Eigen::Vector3d result;
    bool valid = array != nullptr && array->size() == 3;
    for (std::size_t i = 0; valid && i < 3; ++i) {
      const auto& item = (*array)[i];
      valid = item.is_number() && fraction.contains(*item.value<double>());
      result[static_cast<Eigen::Index>(i)] = valid ? *item.value<double>() : 0;
    }
    if (!valid) {
      refuse(key, "expected three fractions of the bounding box from 0 to 1, such as [0.5, 1, 0.5]");
      return std::nullopt;
    }
    return result;
  }

 private:
  const toml::table& table_;
  std::string name_;
  Problems& problems_;
};

template <typename T, typename U>
void set_if(T& target, const std::optional<U>& value) {
  if (value) {
    target = static_cast<T>(*value);
  }
}

/// The named table of a scene, if it is there and a table.
std::optional<Table> section(const Table& scene, std::string_view name, std::initializer_list<std::string_view> valid) {
  const auto* node = scene.find(name);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_table()) {
    scene.refuse(name, "is " + std::string(kind_of(*node)) + "; expected the table [" + std::string(name) + "]");
    return std::nullopt;
  }
  return Table(*node->as_table(), scene.full(name), valid, scene.problems());
}

std::filesystem::path beside(const std::filesystem::path& scene_file, const std::string& name) {
  return (scene_file.parent_path() / name).lexically_normal();
}

void read_mesh(const Table& scene, const std::filesystem::path& file, MeshSource& mesh) {
  if (scene.has("surface") == scene.has("volume")) {
    scene.problems().add({}, scene.has("volume") ? "volume" : "surface",
                         scene.has("volume")
                             ? "the scene has [surface] and [volume]; keep one of them"
                             : "missing; write for example [surface] file = \"bear.off\", unit = \"cm\"");
  }
  for (const std::string_view name : {"surface", "volume"}) {
    const auto table = section(scene, name, {"file", "unit", "size"});
    if (!table) {
      continue;
    }
    mesh.tetrahedra = name == "volume";
    table->require("file", mesh.tetrahedra ? "file = \"liver.msh\"" : "file = \"bear.off\"");
    set_if(mesh.name, table->string("file"));
    mesh.path = beside(file, mesh.name);
    mesh.unit = table->quantity("unit", Dimension::length);
    mesh.size = table->quantity("size", Dimension::length);
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
  set_if(remesh.levels, table->integer("levels", 0, 7));
  if (tetrahedra && table->has("base_vertices")) {
    table->refuse("base_vertices", "does not go with [volume], whose boundary vertices are kept; remove it");
  }
}

void read_material(const Table& scene, Material& material) {
  if (!scene.has("material")) {
    scene.problems().add({}, "material", "missing; write for example [material] young = \"20 kPa\", poisson = 0.4");
  }
  const auto table = section(scene, "material", {"young", "poisson"});
  if (!table) {
    return;
  }
  table->require("young", "young = \"20 kPa\"");
  table->require("poisson", "poisson = 0.4");
  set_if(material.young, table->quantity("young", Dimension::pressure));
  set_if(material.poisson, table->number("poisson", {-1, 0.5, true, true}));
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

void read_regions(const Table& scene, std::string_view role, std::vector<Region>& regions) {
  const auto* node = scene.find(role);
  if (node == nullptr) {
    return;
  }
  const auto* array = node->as_array();
  const bool tables = array != nullptr && !array->empty() &&
                      std::all_of(array->begin(), array->end(), [](const toml::node& item) { return item.is_table(); });
  if (!tables) {
    scene.refuse(role, "is " + std::string(kind_of(*node)) + "; expected one or more tables [[" + std::string(role) +
                           "]], such as [[" + std::string(role) + "]] below = 0.1, axis = \"y\"");
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const Table table(*(*array)[i].as_table(), std::string(role) + "[" + std::to_string(i) + "]",
                      {"below", "above", "axis", "box", "sphere", "near", "count"}, scene.problems());
    if (auto region = read_region(table)) {
      regions.push_back(std::move(*region));
    }
  }
}

void read_constraints(const Table& scene, int levels, int& coarsest) {
  const auto table = section(scene, "constraints", {"coarsest"});
  if (!table) {
    return;
  }
  if (const auto value = table->integer("coarsest", 0, 7)) {
    coarsest = static_cast<int>(*value);
    if (coarsest > levels) {
      table->refuse("coarsest", std::to_string(coarsest) + " is finer than the finest level; remesh.levels is " +
                                    std::to_string(levels));
    }
  }
}

void read_accuracy(const Table& scene, AccuracyGoal& accuracy) {
  constexpr Interval error{0, 1, true, true};
  if (const auto table = section(scene, "accuracy", {"rms", "worst_column"})) {
    set_if(accuracy.rms, table->number("rms", error));
    set_if(accuracy.worst_column, table->number("worst_column", error));
  }
}

void read_budget(const Table& scene, StepBudget& budget) {
  if (const auto table = section(scene, "budget", {"rate", "work", "contacts"})) {
    set_if(budget.rate, table->quantity("rate", Dimension::frequency));
    budget.work = table->integer("work", 1, 1'000'000'000'000);
    set_if(budget.contacts, table->integer("contacts", 1, 4096));
  }
}

void read_compression(const Table& scene, CompressionChoice& compression) {
  const auto table = section(scene, "compression", {"epsilon", "bits"});
  if (!table) {
    return;
  }
  compression.epsilon = table->number("epsilon", {0, 1, false, true});
  set_if(compression.bits, table->integer("bits", 8, 16));
  if (compression.bits && *compression.bits != 8 && *compression.bits != 16) {
    table->refuse("bits", std::to_string(*compression.bits) + " is not offered; expected 8 or 16");
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

toml::table parse_toml(std::string_view text, const std::filesystem::path& file) {
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    Problems problems(file.string());
    problems.add(error.source().begin, "", std::string(error.description()));
    problems.throw_if_any();
    throw;
  }
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  Problems problems(file.string());
  const Table table(toml, "",
                    {"surface", "volume", "remesh", "material", "fixed", "touched", "read", "constraints", "accuracy",
                     "budget", "compression", "store"},
                    problems);
  Scene scene;
  read_mesh(table, file, scene.mesh);
  read_remesh(table, scene.mesh.tetrahedra, scene.remesh);
  read_material(table, scene.material);
  if (!table.has("fixed")) {
    problems.add({}, "fixed",
                 "missing; something has to hold the body: write for example [[fixed]] below = 0.1, axis = \"y\"");
  }
  read_regions(table, "fixed", scene.fixed);
  read_regions(table, "touched", scene.touched);
  read_regions(table, "read", scene.read);
  read_constraints(table, scene.remesh.levels, scene.coarsest_constraints);
  read_accuracy(table, scene.accuracy);
  read_budget(table, scene.budget);
  read_compression(table, scene.compression);
  read_store(table, file, scene);
  problems.throw_if_any();
  return scene;
}

Scene read_scene(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!stream) {
    throw SceneError({file.string() + ": cannot be read"});
  }
  return parse_scene(text, file);
}

}  // namespace greenloop::offline
