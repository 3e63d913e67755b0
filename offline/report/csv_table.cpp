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

std::string contents(const std::filesystem::path& path) {
  constexpr std::size_t part = std::size_t{1} << 20;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read; does it exist?");
  std::string text;
  while (stream) {
    const std::size_t end = text.size();
    text.resize(end + part);
    stream.read(text.data() + end, part);
    text.resize(end + static_cast<std::size_t>(stream.gcount()));
    if (text.size() > most_csv_bytes) {
      throw std::runtime_error(
          fmt::format("{}: is longer than {} MB; write fewer cycles", path.string(), most_csv_bytes >> 20));
    }
  }
  return text;
}

template <class Number>
bool parse(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

CsvTable CsvTable::load(const std::filesystem::path& path) {
  const std::string text = contents(path);
  CsvTable table;
  table.file_ = path.string();
  for (std::size_t number = 1, begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
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
  for (std::size_t k = 0; k < table.columns_.size(); ++k) {
    if (table.place_.emplace(table.columns_[k], k).second) continue;
    throw std::runtime_error(fmt::format("{}: column '{}' stands there twice", table.file_, table.columns_[k]));
  }
  return table;
}

bool CsvTable::has(std::string_view column) const { return place_.find(column) != place_.end(); }

std::size_t CsvTable::index(std::string_view column) const {
  const auto at = place_.find(column);
  if (at == place_.end()) {
    throw std::runtime_error(
        fmt::format("{}: no column '{}'; there are: {}", file_, column, fmt::join(columns_, ", ")));
  }
  return at->second;
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
    if (!parse(cells[row], values[row]) || !(std::abs(values[row]) <= most_csv_number)) {
      refuse(row, column, fmt::format("a finite number of at most {:g}", most_csv_number));
    }
  }
  return values;
}

std::vector<unsigned long long> CsvTable::counts(std::string_view column, unsigned long long most) const {
  const auto cells = texts(column);
  std::vector<unsigned long long> values(cells.size());
  for (std::size_t row = 0; row < cells.size(); ++row) {
    if (!parse(cells[row], values[row])) refuse(row, column, "a whole number >= 0");
    if (values[row] > most) refuse(row, column, fmt::format("a whole number of at most {}", most));
  }
  return values;
}

}  // namespace greenloop::offline
