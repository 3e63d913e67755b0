#pragma once

// A TOML table read key by key, every problem collected with its place. Only parsers of scenes include this.
#include <toml++/toml.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "offline/scene/scene.hpp"
#include "offline/scene/spelling.hpp"
#include "offline/scene/units.hpp"

namespace greenloop::offline {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline std::string shortest(double value) {
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

inline std::string_view kind_of(const toml::node& node) {
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

  [[nodiscard]] std::optional<bool> boolean(std::string_view key) const {
    const auto* node = find(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    const auto value = node->is_boolean() ? node->value<bool>() : std::nullopt;
    if (!value) {
      refuse(key, "is " + std::string(kind_of(*node)) + "; expected true or false");
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

  /// A direction, of any length but 0.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction(std::string_view key) const {
    const auto* array = find(key)->as_array();
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    const bool three = array != nullptr && array->size() == 3 &&
                       std::all_of(array->begin(), array->end(), [](const auto& item) { return item.is_number(); });
    for (std::size_t i = 0; three && i < 3; ++i) result[static_cast<Eigen::Index>(i)] = *(*array)[i].value<double>();
    if (!result.allFinite() || result.isZero(0)) {
      refuse(key, "expected \"normal\" or three finite numbers that are not all zero, such as [0, 0, -1]");
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
inline std::optional<Table> section(const Table& scene, std::string_view name,
                                    std::initializer_list<std::string_view> valid) {
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

}  // namespace greenloop::offline
