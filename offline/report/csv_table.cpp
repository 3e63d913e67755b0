#include "offline/report/csv_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace greenloop::offline {
namespace {

std::string trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    cells.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

template <class Number>
bool parse(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

CsvTable CsvTable::load(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read; does it exist?");
  CsvTable table;
  table.file_ = path.string();
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    auto cells = split(line);
    if (table.columns_.empty()) {
      table.columns_ = std::move(cells);
      continue;
    }
    if (cells.size() != table.columns_.size()) {
      throw std::runtime_error(fmt::format("{}:{}: {} cells where the header has {} columns; is the file cut off?",
                                           table.file_, number, cells.size(), table.columns_.size()));
    }
    table.cells_.push_back(std::move(cells));
    table.lines_.push_back(number);
  }
  if (table.columns_.empty()) throw std::runtime_error(table.file_ + ": empty; expected a line of column names");
  auto sorted = table.columns_;
  std::sort(sorted.begin(), sorted.end());
  const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
  if (twin != sorted.end())
    throw std::runtime_error(fmt::format("{}: column '{}' stands there twice", table.file_, *twin));
  return table;
}

bool CsvTable::has(std::string_view column) const {
  return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
}

std::size_t CsvTable::index(std::string_view column) const {
  const auto at = std::find(columns_.begin(), columns_.end(), column);
  if (at == columns_.end()) {
    throw std::runtime_error(
        fmt::format("{}: no column '{}'; there are: {}", file_, column, fmt::join(columns_, ", ")));
  }
  return static_cast<std::size_t>(at - columns_.begin());
}

void CsvTable::refuse(std::size_t row, std::string_view column, std::string_view expected) const {
  throw std::runtime_error(fmt::format("{}:{}: column '{}': '{}' is not {}", file_, lines_[row], column,
                                       cells_[row][index(column)], expected));
}

std::vector<std::string> CsvTable::texts(std::string_view column) const {
  const std::size_t at = index(column);
  std::vector<std::string> values;
  values.reserve(cells_.size());
  for (const auto& row : cells_) values.push_back(row[at]);
  return values;
}

std::vector<double> CsvTable::numbers(std::string_view column) const {
  const auto cells = texts(column);
  std::vector<double> values(cells.size());
  for (std::size_t row = 0; row < cells.size(); ++row) {
    if (!parse(cells[row], values[row]) || !std::isfinite(values[row])) refuse(row, column, "a finite number");
  }
  return values;
}

std::vector<unsigned long long> CsvTable::counts(std::string_view column) const {
  const auto cells = texts(column);
  std::vector<unsigned long long> values(cells.size());
  for (std::size_t row = 0; row < cells.size(); ++row) {
    if (!parse(cells[row], values[row])) refuse(row, column, "a whole number >= 0");
  }
  return values;
}

}  // namespace greenloop::offline
