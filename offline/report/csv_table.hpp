#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace greenloop::offline {

/// Numbers in a file are taken up to this magnitude, whatever their unit: their squares and sums stay finite.
inline constexpr double most_csv_number = 1e12;

/// Files are taken up to this length.
inline constexpr std::size_t most_csv_bytes = std::size_t{1} << 28;

/// A comma-separated file with one line of column names; cells as text. Lines that start with '#' are comments.
/// Errors are std::runtime_error with file, line, column, value and what was expected. Work: linear in the file.
/// Memory: at most 40 times the file.
class CsvTable {
 public:
  /// Reads the whole file. Throws if it cannot be read, is longer than most_csv_bytes, has no header, repeats a column,
  /// or a line has other than the header's number of cells.
  [[nodiscard]] static CsvTable load(const std::filesystem::path& path);

  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  [[nodiscard]] bool has(std::string_view column) const;
  /// Throws if there is no such column, naming those there are.
  [[nodiscard]] std::vector<std::string> texts(std::string_view column) const;
  /// Throws also if a cell is no number of at most most_csv_number in magnitude.
  [[nodiscard]] std::vector<double> numbers(std::string_view column) const;
  /// Throws also if a cell is no whole number from 0 to `most`.
  [[nodiscard]] std::vector<unsigned long long> counts(std::string_view column, unsigned long long most = ~0ULL) const;

 private:
  [[nodiscard]] std::size_t index(std::string_view column) const;
  [[noreturn]] void refuse(std::size_t row, std::string_view column, std::string_view expected) const;

  std::string file_;
  std::vector<std::string> columns_;
  std::map<std::string, std::size_t, std::less<>> place_;  ///< of each column
  std::vector<std::vector<std::string>> cells_;            ///< [row][column]
  std::vector<std::size_t> lines_;                         ///< line of each row, from 1
};

}  // namespace greenloop::offline
