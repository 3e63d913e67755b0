#include "offline/sources/reciprocity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace greenloop::offline {
namespace {

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

/// Rows of the shared nodes [rows], columns of the shared nodes [columns], read in one piece. N: the store's
/// components.
template <int N>
class Tile {
 public:
  Tile(const GreenStore& store, const SharedNode* rows, const SharedNode* rows_end, const SharedNode* columns,
       const SharedNode* columns_end)
      : first_row_(rows->row),
        first_column_(columns->column),
        block_(store.read_block(first_row_, (rows_end - 1)->row - first_row_ + 1, first_column_,
                                (columns_end - 1)->column - first_column_ + 1)) {}
  [[nodiscard]] Eigen::Matrix<double, N, N> at(const SharedNode& row, const SharedNode& column) const {
    return block_.template block<N, N>(Eigen::Index{N} * (row.row - first_row_),
                                       Eigen::Index{N} * (column.column - first_column_));
  }

 private:
  int first_row_, first_column_;
  Eigen::MatrixXd block_;
};

template <int N>
double largest_asymmetry_of(const GreenStore& store) {
  constexpr std::size_t kTile = 512;
  const auto shared = shared_nodes(store.contents());
  const auto end_of = [&](std::size_t begin) { return shared.data() + std::min(begin + kTile, shared.size()); };
  std::vector<double> scale(shared.size());
  double largest = 0.0;
  for (std::size_t a = 0; a < shared.size(); a += kTile) {
    const Tile<N> diagonal(store, &shared[a], end_of(a), &shared[a], end_of(a));
    for (const auto* i = &shared[a]; i != end_of(a); ++i)
      scale[i - shared.data()] = std::sqrt(diagonal.at(*i, *i).norm());
  }
  for (std::size_t a = 0; a < shared.size(); a += kTile) {
    for (std::size_t b = a; b < shared.size(); b += kTile) {
      const Tile<N> upper(store, &shared[a], end_of(a), &shared[b], end_of(b));
      const Tile<N> lower(store, &shared[b], end_of(b), &shared[a], end_of(a));
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

}  // namespace

void require_sound(const GreenStore& store) {
  for (int column = 0; column < store.column_count(); ++column) {
    if (store.is_done(column)) (void)store.read_columns(column, 1);
  }
  if (store.missing_columns().empty() && !(largest_asymmetry(store) <= most_asymmetry)) {
    throw std::runtime_error(store.path().string() + ": /green/displacement: reciprocity is violated");
  }
}

double largest_asymmetry(const GreenStore& store) {
  return store.contents().components == 1 ? largest_asymmetry_of<1>(store) : largest_asymmetry_of<3>(store);
}

}  // namespace greenloop::offline
