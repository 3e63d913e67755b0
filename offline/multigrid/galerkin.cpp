#include "offline/multigrid/galerkin.hpp"

#include <algorithm>

namespace greenloop::offline {
namespace {

/// Lists of numbers, one after another.
struct Lists {
  std::vector<std::uint32_t> start{0}, entry;

  void close() { start.push_back(static_cast<std::uint32_t>(entry.size())); }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t list) const {
    return {entry.data() + start[list], entry.data() + start[list + 1]};
  }
};

/// Numbers below `size`, each taken once until the next beginning.
class Collector {
 public:
  explicit Collector(std::uint32_t size) : last_(size, none) {}

  void begin() { ++round_; }
  bool take(std::uint32_t number) {
    if (last_[number] == round_) return false;
    last_[number] = round_;
    return true;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> last_;
  std::uint32_t round_ = none;
};

std::span<const std::uint32_t> parents(const Prolongation& p, std::uint32_t v) {
  return {p.parent.data() + p.start[v], p.parent.data() + p.start[v + 1]};
}

/// The vertices whose parent each coarse vertex is.
Lists children(const Prolongation& p) {
  Lists lists;
  lists.start.assign(p.coarse + 1, 0);
  for (const std::uint32_t parent : p.parent) ++lists.start[parent + 1];
  for (std::uint32_t c = 0; c < p.coarse; ++c) lists.start[c + 1] += lists.start[c];
  lists.entry.resize(p.parent.size());
  std::vector<std::uint32_t> next(lists.start.begin(), lists.start.end() - 1);
  for (std::uint32_t v = 0; v < p.rows(); ++v) {
    for (const std::uint32_t parent : parents(p, v)) lists.entry[next[parent]++] = v;
  }
  return lists;
}

/// The columns of A P in each row.
Lists half_pattern(const BlockMatrix& matrix, const Prolongation& p) {
  Lists lists;
  Collector collector(p.coarse);
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    collector.begin();
    const auto take = [&](std::uint32_t neighbour) {
      for (const std::uint32_t parent : parents(p, neighbour)) {
        if (collector.take(parent)) lists.entry.push_back(parent);
      }
    };
    take(v);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) take(matrix.column[k]);
    lists.close();
  }
  return lists;
}

/// A matrix of zeros with the pattern of P^T A P.
BlockMatrix coarse_pattern(const Prolongation& p, const Lists& half) {
  const Lists child = children(p);
  BlockMatrix coarse;
  coarse.start.push_back(0);
  Collector collector(p.coarse);
  for (std::uint32_t c = 0; c < p.coarse; ++c) {
    collector.begin();
    collector.take(c);
    const auto first = static_cast<std::ptrdiff_t>(coarse.column.size());
    for (const std::uint32_t v : child.of(c)) {
      for (const std::uint32_t column : half.of(v)) {
        if (collector.take(column)) coarse.column.push_back(column);
      }
    }
    std::sort(coarse.column.begin() + first, coarse.column.end());
    const auto upper = std::upper_bound(coarse.column.begin() + first, coarse.column.end(), c);
    coarse.upper.push_back(static_cast<std::uint32_t>(upper - coarse.column.begin()));
    coarse.start.push_back(static_cast<std::uint32_t>(coarse.column.size()));
  }
  coarse.block.resize(coarse.column.size());
  coarse.diagonal.resize(p.coarse);
  return coarse;
}

void add_scaled(DoubleBlock& sum, const DoubleBlock& block, double scale) {
  for (int j = 0; j < 3; ++j) sum.column[j] += block.column[j] * splat(scale);
}

DoubleBlock transposed(const DoubleBlock& b) {
  DoubleBlock t;
  for (int j = 0; j < 3; ++j) t.column[j] = Double4{b.column[0][j], b.column[1][j], b.column[2][j], 0.0};
  return t;
}

/// A row of A P, as blocks at coarse columns.
class HalfRow {
 public:
  explicit HalfRow(std::uint32_t coarse) : place_(coarse, 0) {}

  void compute(const BlockMatrix& matrix, const Prolongation& p, std::span<const std::uint32_t> columns,
               std::uint32_t v) {
    block_.assign(columns.size(), DoubleBlock{});
    for (std::uint32_t i = 0; i < columns.size(); ++i) place_[columns[i]] = i;
    add(p, v, matrix.diagonal[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) add(p, matrix.column[k], matrix.block[k]);
  }
  [[nodiscard]] const DoubleBlock& block(std::size_t i) const { return block_[i]; }

 private:
  void add(const Prolongation& p, std::uint32_t neighbour, const DoubleBlock& block) {
    for (std::uint32_t k = p.start[neighbour]; k < p.start[neighbour + 1]; ++k) {
      add_scaled(block_[place_[p.parent[k]]], block, p.weight[k]);
    }
  }

  std::vector<std::uint32_t> place_;
  std::vector<DoubleBlock> block_;
};

/// The blocks on the diagonal and right of it.
void add_upper(const BlockMatrix& matrix, const Prolongation& p, const Lists& half, BlockMatrix& coarse) {
  HalfRow row(p.coarse);
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    const auto columns = half.of(v);
    row.compute(matrix, p, columns, v);
    for (std::uint32_t k = p.start[v]; k < p.start[v + 1]; ++k) {
      const std::uint32_t c = p.parent[k];
      const auto first = coarse.column.begin() + coarse.upper[c], last = coarse.column.begin() + coarse.start[c + 1];
      for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] == c) add_scaled(coarse.diagonal[c], row.block(i), p.weight[k]);
        if (columns[i] <= c) continue;
        const auto at = std::lower_bound(first, last, columns[i]) - coarse.column.begin();
        add_scaled(coarse.block[static_cast<std::size_t>(at)], row.block(i), p.weight[k]);
      }
    }
  }
}

void mirror(BlockMatrix& matrix) {
  std::vector<std::uint32_t> next(matrix.start.begin(), matrix.start.end() - 1);
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    for (std::uint32_t k = matrix.upper[v]; k < matrix.start[v + 1]; ++k) {
      matrix.block[next[matrix.column[k]]++] = transposed(matrix.block[k]);
    }
  }
}

}  // namespace

BlockMatrix galerkin(const BlockMatrix& matrix, const Prolongation& prolongation) {
  const Lists half = half_pattern(matrix, prolongation);
  BlockMatrix coarse = coarse_pattern(prolongation, half);
  add_upper(matrix, prolongation, half, coarse);
  mirror(coarse);
  return coarse;
}

}  // namespace greenloop::offline
