#include "offline/scene/mesh_series.hpp"

#include <algorithm>
#include <cmath>

#include "offline/scene/toml_source.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {
namespace {

constexpr std::int64_t most_frames = 1'000'000;
constexpr std::string_view at_rest_name = "rest";

/// Where the number goes: begin and end of "%04d", and how many digits it has at least. None unless there is one.
struct NumberPlace {
  std::size_t begin = 0, end = 0, digits = 0;
};

std::optional<NumberPlace> number_place(std::string_view pattern) {
  const auto begin = pattern.find('%');
  if (begin == std::string_view::npos || pattern.find('%', begin + 1) != std::string_view::npos) return std::nullopt;
  NumberPlace place{begin, begin + 1, 0};
  if (place.end + 1 < pattern.size() && pattern[place.end] == '0' && pattern[place.end + 1] >= '1' &&
      pattern[place.end + 1] <= '9') {
    place.digits = static_cast<std::size_t>(pattern[place.end + 1] - '0');
    place.end += 2;
  }
  if (place.end >= pattern.size() || pattern[place.end] != 'd') return std::nullopt;
  ++place.end;
  return place;
}

/// Calls read(table) for each of [[name]].
template <class Read>
void read_each(const Table& parent, std::string_view name, std::initializer_list<std::string_view> valid,
               const Read& read) {
  const auto* const node = parent.find(name);
  const auto* const array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr || array->empty()) {
    parent.refuse(name, "expected one or more tables [[" + std::string(name) + "]]");
    return;
  }
  for (const toml::node& item : *array) {
    if (!item.is_table()) {
      parent.refuse(name, "expected tables [[" + std::string(name) + "]]");
      return;
    }
    read(Table(*item.as_table(), std::string(name), valid, parent.problems()));
  }
}

void read_numbers(const Table& table, std::string_view key, std::array<double, 4>& numbers) {
  if (!table.has(key)) return;
  const auto* const array = table.find(key)->as_array();
  const bool fits = array != nullptr && array->size() <= numbers.size() &&
                    std::all_of(array->begin(), array->end(), [](const auto& item) {
                      return item.is_number() && std::isfinite(*item.template value<double>());
                    });
  if (!fits) {
    table.refuse(key, "expected at most four numbers, such as [1, 0, 0]");
    return;
  }
  for (std::size_t k = 0; k < array->size(); ++k) numbers[k] = *(*array)[k].value<double>();
}

std::vector<std::string_view> names_of(const std::vector<Impulse>& impulses, bool with_rest) {
  std::vector<std::string_view> names(impulses.size());
  std::transform(impulses.begin(), impulses.end(), names.begin(),
                 [](const Impulse& impulse) -> std::string_view { return impulse.name; });
  if (with_rest) names.push_back(at_rest_name);
  return names;
}

/// The place of a name among others; none, and a problem, if it is not there.
std::optional<std::size_t> place_of(const Table& table, std::string_view key, const std::string& name,
                                    const std::vector<std::string_view>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  table.refuse(
      key, "\"" + name + "\" is none of the impulses" + did_you_mean(name, names) + "; there are " + comma_list(names));
  return std::nullopt;
}

/// Names of `after`; none if any impulse and rest will do.
std::optional<std::vector<std::string>> read_after(const Table& table) {
  const auto* const node = table.find("after");
  if (node == nullptr) return std::nullopt;
  std::vector<std::string> names;
  const auto* const array = node->as_array();
  for (std::size_t k = 0; array != nullptr && k < array->size(); ++k) {
    if (const auto name = (*array)[k].value<std::string>()) names.push_back(*name);
  }
  if (array == nullptr || names.size() != array->size()) {
    table.refuse("after", "expected names of impulses, or \"rest\", such as [\"rest\", \"push\"]");
  }
  return names;
}

/// Without `after`, an impulse may follow any.
void read_impulses(const Table& root, MeshSeries& series) {
  std::vector<std::pair<Table, std::optional<std::vector<std::string>>>> read;
  read_each(root, "impulse", {"name", "initial", "persistent", "after"}, [&](const Table& table) {
    Impulse impulse;
    table.require("name", "name = \"push\"");
    set_if(impulse.name, table.string("name"));
    if (impulse.name == at_rest_name) table.refuse("name", "\"rest\" stands for the scene at rest; take another name");
    read_numbers(table, "initial", impulse.initial);
    read_numbers(table, "persistent", impulse.persistent);
    series.impulses.push_back(impulse);
    read.emplace_back(table, read_after(table));
  });
  const std::size_t count = series.impulses.size();
  const auto names = names_of(series.impulses, true);
  series.successions.assign((count + 1) * count, 0);
  for (std::size_t impulse = 0; impulse < count; ++impulse) {
    const auto& [table, after] = read[impulse];
    for (std::size_t before = 0; !after && before <= count; ++before) series.successions[before * count + impulse] = 1;
    for (std::size_t k = 0; after && k < after->size(); ++k) {
      const auto before = place_of(table, "after", (*after)[k], names);
      if (before) series.successions[*before * count + impulse] = 1;
    }
  }
}

void read_previous(const Table& table, const MeshSeries& series, OrbitSeries& orbit) {
  if (!table.has("previous")) return;
  const auto* const array = table.find("previous")->as_array();
  const bool two = array != nullptr && array->size() == 2 && (*array)[0].is_integer() && (*array)[1].is_integer();
  const std::int64_t before = two ? *(*array)[0].value<std::int64_t>() : -1;
  const std::int64_t frame = two ? *(*array)[1].value<std::int64_t>() : -1;
  const auto count = static_cast<std::int64_t>(series.orbits.size());
  if (before < 0 || before >= count || frame < 0 ||
      frame >= static_cast<std::int64_t>(series.orbits[static_cast<std::size_t>(before)].count)) {
    table.refuse("previous", "expected an orbit before this one and a frame of it, both counted from 0, as [0, 12]");
    return;
  }
  orbit.previous = {static_cast<std::uint64_t>(before), static_cast<std::uint64_t>(frame)};
}

void read_orbits(const Table& root, const std::filesystem::path& file, MeshSeries& series) {
  const auto names = names_of(series.impulses, false);
  read_each(root, "orbit", {"impulse", "frames", "first", "count", "previous", "at_rest", "held_out"},
            [&](const Table& table) {
              OrbitSeries orbit;
              table.require("impulse", "impulse = \"push\"");
              table.require("frames", "frames = \"push_%04d.obj\"");
              table.require("count", "count = 120");
              const auto name = table.string("impulse");
              if (name) set_if(orbit.impulse, place_of(table, "impulse", *name, names));
              const auto pattern = table.string("frames");
              if (pattern && !number_place(*pattern)) {
                table.refuse("frames", "needs one place such as %04d or %d for the number of the file");
              }
              if (pattern) orbit.pattern = beside(file, *pattern).string();
              set_if(orbit.first, table.integer("first", 0, most_frames));
              set_if(orbit.count, table.integer("count", 2, most_frames));
              set_if(orbit.at_rest, table.boolean("at_rest"));
              set_if(orbit.held_out, table.boolean("held_out"));
              read_previous(table, series, orbit);
              series.orbits.push_back(orbit);
            });
}

}  // namespace

std::filesystem::path OrbitSeries::file(std::uint64_t k) const {
  const auto place = number_place(pattern).value_or(NumberPlace{pattern.size(), pattern.size(), 0});
  std::string number = std::to_string(first + static_cast<std::int64_t>(k));
  if (number.size() < place.digits) number.insert(0, place.digits - number.size(), '0');
  return pattern.substr(0, place.begin) + number + pattern.substr(place.end);
}

MeshSeries parse_mesh_series(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  Problems problems(file.string());
  const Table table(toml, "", {"rate", "unit", "rest", "impulse", "orbit"}, problems);
  MeshSeries series;
  table.require("rate", "rate = \"60 Hz\"");
  table.require("unit", "unit = \"cm\"");
  table.require("rest", "rest = \"rest.obj\"");
  if (const auto rate = table.quantity("rate", Dimension::frequency)) series.time_step = 1 / *rate;
  set_if(series.unit, table.quantity("unit", Dimension::length));
  if (const auto rest = table.string("rest")) series.rest = beside(file, *rest);
  read_impulses(table, series);
  read_orbits(table, file, series);
  problems.throw_if_any();
  return series;
}

MeshSeries read_mesh_series(const std::filesystem::path& file) {
  return parse_mesh_series(scene_file_text(file), file);
}

}  // namespace greenloop::offline
