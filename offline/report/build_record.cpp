#include "offline/report/build_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "offline/report/axis.hpp"

namespace greenloop::offline {
namespace {

using nlohmann::json;

struct KnownSuffix {
  std::string_view suffix;
  std::string_view unit;
  double factor;
};

/// Keys carry their unit as a suffix; what is relative reads as a percentage.
constexpr std::array<KnownSuffix, 7> known_suffixes{{{"_degrees", "°", 1},
                                                     {"_relative", "%", 100},
                                                     {"_seconds", "s", 1},
                                                     {"_bytes", "B", 1},
                                                     {"_metres", "m", 1},
                                                     {"_pa", "Pa", 1},
                                                     {"seconds", "s", 1}}};

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string scalar_text(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_unsigned()) return readable_count(value.get<unsigned long long>());
  if (value.is_number()) return readable(value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const json& element : value) list += (list.empty() ? "" : ", ") + scalar_text(element);
  return list.empty() ? "none" : list;
}

Fact fact(const std::string& prefix, const std::string& key, const json& value) {
  for (const auto& [suffix, unit, factor] : known_suffixes) {
    if (!value.is_number() || !key.ends_with(suffix)) continue;
    const std::string name = key == suffix ? key : key.substr(0, key.size() - suffix.size());
    return {prefix + words(name), readable(factor * value.get<double>()) + "\u202f" + std::string(unit)};
  }
  return {prefix + words(key), scalar_text(value)};
}

void append_facts(const json& object, const std::string& prefix, std::vector<Fact>& facts) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      append_facts(value, prefix + words(key) + " / ", facts);
    } else {
      facts.push_back(fact(prefix, key, value));
    }
  }
}

std::vector<FactGroup> fact_groups(const json& object, const std::string& title) {
  std::vector<FactGroup> groups{{title, {}}};
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object()) {
      groups.front().facts.push_back(fact("", key, value));
      continue;
    }
    groups.push_back({words(key), {}});
    append_facts(value, "", groups.back().facts);
  }
  std::erase_if(groups, [](const FactGroup& group) { return group.facts.empty(); });
  return groups;
}

/// Reads parts of the record and names the key that is wrong.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] const json* part(const json& object, const std::string& key, json::value_t type,
                                 const char* expected) const {
    const auto at = object.find(key);
    if (at == object.end() || at->is_null()) return nullptr;
    const bool numbers = type == json::value_t::number_float && at->is_number();
    if (!numbers && at->type() != type) {
      throw std::runtime_error(file_ + ": '" + key + "' is " + at->type_name() + ", expected " + expected);
    }
    return &*at;
  }
  [[nodiscard]] const json* object(const json& in, const std::string& key) const {
    return part(in, key, json::value_t::object, "an object");
  }
  [[nodiscard]] const json* array(const json& in, const std::string& key) const {
    return part(in, key, json::value_t::array, "an array");
  }
  [[nodiscard]] std::optional<double> number(const json& in, const std::string& key) const {
    const json* value = part(in, key, json::value_t::number_float, "a number");
    return value != nullptr ? std::optional(value->get<double>()) : std::nullopt;
  }
  [[nodiscard]] std::string text(const json& in, const std::string& key) const {
    const json* value = part(in, key, json::value_t::string, "a text");
    return value != nullptr ? value->get<std::string>() : std::string();
  }
  void check_object(const json& value, const std::string& key) const {
    if (value.is_object()) return;
    throw std::runtime_error(file_ + ": an element of '" + key + "' is " + value.type_name() + ", expected an object");
  }

 private:
  std::string file_;
};

void read_stages(const Reader& reader, const json& root, BuildRecord& record) {
  const json* stages = reader.array(root, "stages");
  if (stages == nullptr) return;
  for (const json& stage : *stages) {
    reader.check_object(stage, "stages");
    const auto seconds = reader.number(stage, "seconds");
    if (seconds) record.stages.push_back({reader.text(stage, "name"), *seconds});
  }
}

std::optional<ErrorPoint> error_point(const Reader& reader, const json& point) {
  const auto epsilon = reader.number(point, "epsilon"), rms = reader.number(point, "rms_error");
  if (!epsilon || !rms || !(*rms > 0) || !std::isfinite(*rms)) return std::nullopt;
  return ErrorPoint{.epsilon = *epsilon,
                    .rms_error = *rms,
                    .worst_column_error = reader.number(point, "worst_column_error"),
                    .kept_blocks = reader.number(point, "kept_blocks"),
                    .bytes = reader.number(point, "bytes"),
                    .sum_work = reader.number(point, "sum_work")};
}

/// The constraint level that was compressed with the chosen threshold is a point of the curve as well.
void append_chosen(const Reader& reader, const json& compression, BuildRecord& record) {
  const json* levels = reader.array(compression, "constraint_levels");
  const auto same = [&](double epsilon) { return record.epsilon && std::abs(epsilon - *record.epsilon) < 1e-9; };
  const bool present = std::any_of(record.curve.begin(), record.curve.end(),
                                   [&](const ErrorPoint& point) { return same(point.epsilon); });
  if (levels == nullptr || present) return;
  for (const json& level : *levels) {
    reader.check_object(level, "constraint_levels");
    auto point = error_point(reader, level);
    if (!point || !same(point->epsilon)) continue;
    const auto columns = reader.number(level, "columns");
    if (point->kept_blocks && columns && *columns > 0) point->sum_work = 9 * *point->kept_blocks / *columns;
    record.curve.push_back(*point);
    return;
  }
}

void read_compression(const Reader& reader, const json& root, BuildRecord& record) {
  const json* compression = reader.object(root, "compression");
  if (compression == nullptr) return;
  record.epsilon = reader.number(*compression, "epsilon");
  const auto columns = reader.number(*compression, "curve_columns");
  if (columns && *columns >= 0) record.curve_columns = static_cast<unsigned long long>(*columns);
  if (const json* curve = reader.array(*compression, "curve")) {
    for (const json& point : *curve) {
      reader.check_object(point, "curve");
      if (const auto read = error_point(reader, point)) record.curve.push_back(*read);
    }
  }
  append_chosen(reader, *compression, record);
  std::stable_sort(record.curve.begin(), record.curve.end(),
                   [](const ErrorPoint& a, const ErrorPoint& b) { return a.epsilon < b.epsilon; });
}

}  // namespace

BuildRecord load_build_record(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read; does it exist?");
  json root;
  try {
    root = json::parse(stream);
  } catch (const json::parse_error& error) {
    throw std::runtime_error(path.string() + ": no JSON: " + error.what());
  }
  if (!root.is_object()) throw std::runtime_error(path.string() + ": is " + root.type_name() + ", expected an object");
  const Reader reader(path.string());
  BuildRecord record;
  record.scene = reader.text(root, "scene");
  read_stages(reader, root, record);
  for (const char* part : {"surface", "remesh", "volume", "solve"}) {
    if (const json* object = reader.object(root, part)) merge_facts(record.groups, fact_groups({{part, *object}}, ""));
  }
  read_compression(reader, root, record);
  return record;
}

std::vector<FactGroup> facts_of_json(const std::string& text, const std::string& title) {
  const json root = json::parse(text, nullptr, false);
  return root.is_object() ? fact_groups(root, title) : std::vector<FactGroup>{};
}

void merge_facts(std::vector<FactGroup>& groups, const std::vector<FactGroup>& more) {
  for (const FactGroup& group : more) {
    const auto at =
        std::find_if(groups.begin(), groups.end(), [&](const FactGroup& g) { return g.title == group.title; });
    if (at == groups.end()) {
      groups.push_back(group);
      continue;
    }
    for (const Fact& fact : group.facts) {
      const bool known =
          std::any_of(at->facts.begin(), at->facts.end(), [&](const Fact& f) { return f.name == fact.name; });
      if (!known) at->facts.push_back(fact);
    }
  }
}

}  // namespace greenloop::offline
