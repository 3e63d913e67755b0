#include "offline/sources/fill_store.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace greenloop::offline {
namespace {

/// Consecutive missing columns, between multiples of the longest: a resumed run asks for the same ranges as one that
/// was never interrupted, and gets the same bits.
struct ColumnRange {
  int first, count;
};

std::vector<ColumnRange> ranges_of(const std::vector<int>& missing, std::size_t longest) {
  std::vector<ColumnRange> ranges;
  for (const int column : missing) {
    const bool extends = !ranges.empty() && static_cast<std::size_t>(ranges.back().count) < longest &&
                         column == ranges.back().first + ranges.back().count &&
                         static_cast<std::size_t>(column) % longest != 0;
    if (extends) {
      ++ranges.back().count;
    } else {
      ranges.push_back({column, 1});
    }
  }
  return ranges;
}

void require_fit(const GreenStore& store, const ColumnSource& source) {
  const auto refuse = [&](const std::string& what) {
    throw std::runtime_error(store.path().string() + ": /green/displacement: " + what);
  };
  const auto& contents = store.contents();
  if (source.components() != contents.components || source.unit() != contents.unit) {
    const auto said = [](int components, std::string_view unit) {
      return std::to_string(components) + " components and are in " + std::string(unit);
    };
    refuse("the store's columns have " + said(contents.components, contents.unit) + "; the source's have " +
           said(source.components(), source.unit()));
  }
  if (source.rows().interior != 0) {
    refuse("a store holds rows of surface nodes only; the source has " + std::to_string(source.rows().interior) +
           " rows inside the body");
  }
  const auto columns = source.column_nodes();
  if (source.rows().surface_nodes != contents.row_node ||
      !std::equal(columns.begin(), columns.end(), contents.column_node.begin(), contents.column_node.end())) {
    refuse("the source's nodes are not those of /green/row_node and /green/column_node");
  }
}

}  // namespace

FillReport fill_store(GreenStore& store, ColumnSource& source, const FillProgressCallback& progress) {
  using Clock = std::chrono::steady_clock;
  require_fit(store, source);
  const auto start = Clock::now();
  const auto missing = store.missing_columns();
  FillReport report;
  for (const auto& [first, count] : ranges_of(missing, source.columns_at_once())) {
    std::vector<int> columns(static_cast<std::size_t>(count));
    std::iota(columns.begin(), columns.end(), first);
    store.write_columns(first, source.read(columns));
    report.columns += count;
    report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (!progress) continue;
    const int left = static_cast<int>(missing.size()) - report.columns;
    progress({1.0 - static_cast<double>(left) / store.column_count(), report.seconds / report.columns * left});
  }
  return report;
}

}  // namespace greenloop::offline
