#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "offline/figures/column_compression.hpp"

namespace greenloop::offline {

/// Measured columns in a CSV file that grows by a line each, so that a run that was killed is taken up again.
class ColumnRecords {
 public:
  /// Reads what `file` holds, if there is one, and opens it for more. `body` names body and wavelet; thresholds must be
  /// those of the file. Throws std::runtime_error if the file is of something else or cannot be written.
  ColumnRecords(const std::filesystem::path& file, std::string body, const std::vector<double>& thresholds);

  [[nodiscard]] bool has(std::size_t row) const { return columns_.count(row) != 0; }
  [[nodiscard]] const CompressedColumn& at(std::size_t row) const { return columns_.at(row); }

  /// Also written to the file at once.
  void add(std::size_t row, CompressedColumn column);

 private:
  void require_written() const;
  void load(const std::filesystem::path& file, const std::vector<double>& thresholds);

  std::filesystem::path file_;
  std::string body_;
  std::map<std::size_t, CompressedColumn> columns_;
  std::ofstream stream_;
};

}  // namespace greenloop::offline
