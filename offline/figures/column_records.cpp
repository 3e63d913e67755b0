#include "offline/figures/column_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats/output/output_file.hpp"
#include "offline/report/csv_table.hpp"

namespace greenloop::offline {
namespace {

constexpr std::string_view first_names = "body,row,exact energy";

// as a process leaves it that is killed while it writes
void drop_unfinished_line(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t known = std::min(text.size(), first_names.size());
  if (text.compare(0, known, first_names, 0, known) != 0) {
    throw std::runtime_error(file.string() + ": is there, but holds no records; name another file");
  }
  const std::size_t last = text.rfind('\n');
  std::filesystem::resize_file(file, last == std::string::npos ? 0 : last + 1);
}

std::string kept_name(double threshold) { return fmt::format("kept {}", threshold); }
std::string error_name(double threshold) { return fmt::format("error energy {}", threshold); }
std::string worst_name(double threshold) { return fmt::format("worst {}", threshold); }

}  // namespace

ColumnRecords::ColumnRecords(const std::filesystem::path& file, std::string body, const std::vector<double>& thresholds)
    : file_(file), body_(std::move(body)) {
  if (is_special(file)) throw std::runtime_error(file.string() + ": records must be a file; name one");
  if (std::filesystem::exists(file)) drop_unfinished_line(file);
  const bool resumed = std::filesystem::exists(file) && std::filesystem::file_size(file) > 0;
  if (resumed) load(file, thresholds);
  stream_.open(file, std::ios::app);
  if (!resumed) {
    stream_ << first_names;
    for (const double t : thresholds) stream_ << fmt::format(",{},{},{}", kept_name(t), error_name(t), worst_name(t));
    stream_ << std::endl;
  }
  require_written();
}

void ColumnRecords::require_written() const {
  if (!stream_) throw std::runtime_error(write_fault(file_, errno));
}

void ColumnRecords::load(const std::filesystem::path& file, const std::vector<double>& thresholds) {
  const CsvTable table = CsvTable::load(file);
  const auto bodies = table.texts("body");
  if (std::any_of(bodies.begin(), bodies.end(), [&](const std::string& body) { return body != body_; })) {
    throw std::runtime_error(file.string() + ": holds columns of another body or wavelet; name another file");
  }
  const auto rows = table.counts("row");
  const auto exact = table.numbers("exact energy");
  std::vector<CompressedColumn> columns(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) columns[i].exact_energy = exact[i];
  for (const double threshold : thresholds) {
    const auto kept = table.counts(kept_name(threshold));
    const auto error = table.numbers(error_name(threshold)), worst = table.numbers(worst_name(threshold));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      columns[i].trials.push_back({static_cast<std::size_t>(kept[i]), error[i], worst[i]});
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) columns_[static_cast<std::size_t>(rows[i])] = std::move(columns[i]);
}

void ColumnRecords::add(std::size_t row, CompressedColumn column) {
  stream_ << fmt::format("{},{},{}", body_, row, column.exact_energy);
  for (const ColumnTrial& trial : column.trials) {
    stream_ << fmt::format(",{},{},{}", trial.kept, trial.error_energy, trial.worst);
  }
  stream_ << std::endl;
  require_written();
  columns_[row] = std::move(column);
}

}  // namespace greenloop::offline
