#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace greenloop::offline {

/// A comma-separated file with one line of column names; cells as text. Lines that start with '#' are comments.
/// Errors are std::runtime_error with file, line, column, value and what was expected.
class CsvTable {
 public:
  /// Reads the whole file. Throws if it cannot be read, has no header, repeats a column, or a line has other than the
  /// header's number of cells.
  [[nodiscard]] static CsvTable load(const std::filesystem::path& path);

  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  [[nodiscard]] bool has(std::string_view column) const;
  /// Throws if there is no such column, naming those there are.
  [[nodiscard]] std::vector<std::string> texts(std::string_view column) const;
  /// Throws also if a cell is no finite number.
  [[nodiscard]] std::vector<double> numbers(std::string_view column) const;
  /// Throws also if a cell is no whole number >= 0.
  [[nodiscard]] std::vector<unsigned long long> counts(std::string_view column) const;

 private:
  [[nodiscard]] std::size_t index(std::string_view column) const;
  [[noreturn]] void refuse(std::size_t row, std::string_view column, std::string_view expected) const;

  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> cells_;  ///< [row][column]
  std::vector<std::size_t> lines_;               ///< line of each row, from 1
};

}  // namespace greenloop::offline
