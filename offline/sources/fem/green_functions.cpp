#include "offline/sources/fem/green_functions.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "offline/sources/fem/compliance_solver.hpp"
#include "offline/sources/fem/support.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {
namespace {

constexpr double kMostAsymmetry = 1e-8;

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Consecutive missing columns, split into blocks.
struct ColumnRange {
  int first, count;
};

std::vector<ColumnRange> blocks_of(const std::vector<int>& missing) {
  std::vector<ColumnRange> ranges;
  for (const int column : missing) {
    const bool extends = !ranges.empty() && ranges.back().count < ComplianceSolver::kPatternsAtOnce &&
                         column == ranges.back().first + ranges.back().count;
    if (extends) {
      ++ranges.back().count;
    } else {
      ranges.push_back({column, 1});
    }
  }
  return ranges;
}

void require_solvable(const GreenStore& store) {
  const auto& contents = store.contents();
  if (contents.volume.vertices.empty()) {
    throw std::runtime_error(store.path().string() +
                             ": /volume: there is no volume to solve; only a store with tetrahedra can be completed");
  }
  require_supported(contents.volume, contents.volume_fixed);
  require_independent(contents.interpolation, contents.column_node, contents.volume_fixed);
}

void solve_missing(GreenStore& store, const std::vector<int>& missing, const SolveProgressCallback& progress,
                   SolveReport& report) {
  const Stopwatch factor_time;
  ComplianceSolver compliance(store.contents());
  report.factor_seconds = factor_time.seconds();
  report.factor_entries = compliance.factor_entries();
  report.unknowns = compliance.unknowns();

  const Stopwatch solve_time;
  const int total = store.column_count(), to_solve = static_cast<int>(missing.size());
  for (const auto& range : blocks_of(missing)) {
    store.write_columns(
        range.first, compliance.displacement(unit_patterns(
                         store.contents(), std::span(store.contents().column_node).subspan(range.first, range.count))));
    report.columns_solved += range.count;
    report.solve_seconds = solve_time.seconds();
    if (!progress) continue;
    const int left = to_solve - report.columns_solved;
    progress({1.0 - static_cast<double>(left) / total, report.solve_seconds / report.columns_solved * left});
  }
}

/// A node that is both column and row.
struct SharedNode {
  int column, row;
};

std::vector<SharedNode> shared_nodes(const GreenStoreContents& contents) {
  std::vector<SharedNode> shared;
  for (std::size_t c = 0; c < contents.column_node.size(); ++c) {
    const auto row = std::lower_bound(contents.row_node.begin(), contents.row_node.end(), contents.column_node[c]);
    if (row == contents.row_node.end() || *row != contents.column_node[c]) continue;
    shared.push_back({static_cast<int>(c), static_cast<int>(row - contents.row_node.begin())});
  }
  return shared;
}

/// Rows of the shared nodes [rows], columns of the shared nodes [columns], read in one piece.
class Tile {
 public:
  Tile(const GreenStore& store, const SharedNode* rows, const SharedNode* rows_end, const SharedNode* columns,
       const SharedNode* columns_end)
      : first_row_(rows->row),
        first_column_(columns->column),
        block_(store.read_block(first_row_, (rows_end - 1)->row - first_row_ + 1, first_column_,
                                (columns_end - 1)->column - first_column_ + 1)) {}
  [[nodiscard]] Eigen::Matrix3d at(const SharedNode& row, const SharedNode& column) const {
    return block_.block<3, 3>(Eigen::Index{3} * (row.row - first_row_),
                              Eigen::Index{3} * (column.column - first_column_));
  }

 private:
  int first_row_, first_column_;
  Eigen::MatrixXd block_;
};

}  // namespace

SolveReport solve_green_functions(GreenStore& store, const SolveProgressCallback& progress) {
  require_solvable(store);
  SolveReport report;
  const auto missing = store.missing_columns();
  if (!missing.empty()) solve_missing(store, missing, progress, report);
  report.largest_asymmetry = largest_asymmetry(store);
  if (!(report.largest_asymmetry <= kMostAsymmetry)) {
    throw std::runtime_error(store.path().string() + ": /green/displacement: reciprocity is violated by " +
                             std::to_string(report.largest_asymmetry) +
                             "; the tetrahedra are too badly shaped, remesh the surface");
  }
  return report;
}

double largest_asymmetry(const GreenStore& store) {
  constexpr std::size_t kTile = 512;
  const auto shared = shared_nodes(store.contents());
  const auto end_of = [&](std::size_t begin) { return shared.data() + std::min(begin + kTile, shared.size()); };
  std::vector<double> scale(shared.size());
  double largest = 0.0;
  for (std::size_t a = 0; a < shared.size(); a += kTile) {
    const Tile diagonal(store, &shared[a], end_of(a), &shared[a], end_of(a));
    for (const auto* i = &shared[a]; i != end_of(a); ++i)
      scale[i - shared.data()] = std::sqrt(diagonal.at(*i, *i).norm());
  }
  for (std::size_t a = 0; a < shared.size(); a += kTile) {
    for (std::size_t b = a; b < shared.size(); b += kTile) {
      const Tile upper(store, &shared[a], end_of(a), &shared[b], end_of(b));
      const Tile lower(store, &shared[b], end_of(b), &shared[a], end_of(a));
      for (const auto* i = &shared[a]; i != end_of(a); ++i) {
        for (const auto* j = &shared[b]; j != end_of(b); ++j) {
          const double difference = (upper.at(*i, *j) - lower.at(*j, *i).transpose()).norm();
          largest = std::max(largest, difference / (scale[i - shared.data()] * scale[j - shared.data()]));
        }
      }
    }
  }
  return largest;
}

}  // namespace greenloop::offline
