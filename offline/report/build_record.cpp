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
  return value.dump();
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

void read_compression(const Reader& reader, const json& root, BuildRecord& record) {
  const json* compression = reader.object(root, "compression");
  if (compression == nullptr) return;
  record.epsilon = reader.number(*compression, "epsilon");
  const json* curve = reader.array(*compression, "curve");
  if (curve == nullptr) return;
  for (const json& point : *curve) {
    reader.check_object(point, "curve");
    const auto epsilon = reader.number(point, "epsilon"), rms = reader.number(point, "rms_error");
    if (!epsilon || !rms || !(*rms > 0) || !std::isfinite(*rms)) continue;
    record.curve.push_back({.epsilon = *epsilon,
                            .rms_error = *rms,
                            .worst_column_error = reader.number(point, "worst_column_error"),
                            .kept_blocks = reader.number(point, "kept_blocks"),
                            .bytes = reader.number(point, "bytes"),
                            .sum_work = reader.number(point, "sum_work")});
  }
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
  if (const json* remesh = reader.object(root, "remesh")) append_facts(*remesh, "", record.remesh);
  if (const json* solve = reader.object(root, "solve")) append_facts(*solve, "", record.solve);
  read_compression(reader, root, record);
  return record;
}

std::vector<Fact> facts_of_json(const std::string& text) {
  const json root = json::parse(text, nullptr, false);
  std::vector<Fact> facts;
  if (root.is_object()) append_facts(root, "", facts);
  return facts;
}

}  // namespace greenloop::offline
