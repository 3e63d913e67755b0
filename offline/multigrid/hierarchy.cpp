#include "offline/multigrid/hierarchy.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

std::vector<Block<3>> in_single_precision(const std::vector<DoubleBlock>& blocks) {
  std::vector<Block<3>> result(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t j = 0; j < 3; ++j) result[i].column[j] = __builtin_convertvector(blocks[i].column[j], Float4);
  }
  return result;
}

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  const Eigen::Index order = Eigen::Index{3} * matrix.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(order, order);
  const auto place = [&result](std::uint32_t row, std::uint32_t column, const DoubleBlock& block) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) result(Eigen::Index{3} * row + i, Eigen::Index{3} * column + j) = block.column[j][i];
    }
  };
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    place(v, v, matrix.diagonal[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) place(v, matrix.column[k], matrix.block[k]);
  }
  return result;
}

/// As CoarsestFactor has it.
std::vector<double> packed(const Eigen::MatrixXd& lower) {
  std::vector<double> rows;
  for (Eigen::Index i = 0; i < lower.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) rows.push_back(lower(i, j));
    rows.push_back(1.0 / lower(i, i));
  }
  return rows;
}

template <class Value>
std::size_t bytes_of(const std::vector<Value>& values) {
  return sizeof(Value) * values.size();
}

}  // namespace

Hierarchy::Hierarchy(const BlockMatrix& matrix, const std::vector<Prolongation>& prolongations) {
  BlockMatrix coarse;
  const BlockMatrix* level = &matrix;
  for (const Prolongation& prolongation : prolongations) {
    if (prolongation.rows() != level->rows()) {
      throw std::invalid_argument("multigrid: a prolongation to " + std::to_string(prolongation.rows()) +
                                  " vertices stands at a level of " + std::to_string(level->rows()));
    }
    add_level(*level, prolongation);
    coarse = galerkin(*level, prolongation);
    level = &coarse;
  }
  factor(*level);
  for (const Level& each : levels_) views_.push_back(each.view());
  for (Fields& each : fields_) field_views_.push_back({each.b, each.x});
}

MultigridLevel Hierarchy::Level::view() const {
  return {start, upper, column, block, inverse, parent_start, parent, weight};
}

void Hierarchy::add_level(const BlockMatrix& matrix, const Prolongation& prolongation) {
  levels_.push_back({matrix.start,
                     matrix.upper,
                     matrix.column,
                     prolongation.start,
                     prolongation.parent,
                     in_single_precision(matrix.block),
                     in_single_precision(inverse_diagonal(matrix)),
                     {prolongation.weight.begin(), prolongation.weight.end()}});
  fields_.push_back({std::vector<Float4>(matrix.rows()), std::vector<Float4>(matrix.rows())});
}

void Hierarchy::factor(const BlockMatrix& matrix) {
  // a coarse vertex may hang on no fine vertex that others do not: then nothing holds its part of the sum
  constexpr double kRidge = 1.0e-10;
  Eigen::MatrixXd coarsest = dense(matrix);
  coarsest.diagonal() *= 1.0 + kRidge;
  const Eigen::LLT<Eigen::MatrixXd> factor(coarsest);
  if (factor.info() != Eigen::Success) {
    throw std::invalid_argument("multigrid: the coarsest level is not positive definite; is the body held?");
  }
  coarsest_ = packed(factor.matrixLLT());
  scratch_.resize(std::size_t{3} * matrix.rows());
  fields_.push_back({std::vector<Float4>(matrix.rows()), std::vector<Float4>(matrix.rows())});
}

void Hierarchy::cycle(std::span<const Double4> r, std::span<Double4> z) {
  Fields& finest = fields_.front();
  for (std::size_t v = 0; v < r.size(); ++v) finest.b[v] = __builtin_convertvector(r[v], Float4);
  v_cycle({views_, coarsest(), field_views_, scratch_});
  for (std::size_t v = 0; v < z.size(); ++v) z[v] = __builtin_convertvector(finest.x[v], Double4);
}

CoarsestFactor Hierarchy::coarsest() const { return {static_cast<std::uint32_t>(fields_.back().b.size()), coarsest_}; }

std::vector<Hierarchy::LevelSize> Hierarchy::sizes() const {
  std::vector<LevelSize> sizes;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const Level& level = levels_[l];
    sizes.push_back({level.inverse.size(), level.block.size() + level.inverse.size(),
                     bytes_of(level.start) + bytes_of(level.upper) + bytes_of(level.column) +
                         bytes_of(level.parent_start) + bytes_of(level.parent) + bytes_of(level.block) +
                         bytes_of(level.inverse) + bytes_of(level.weight) + 2 * bytes_of(fields_[l].b)});
  }
  const std::size_t coarsest = fields_.back().b.size();
  sizes.push_back(
      {coarsest, coarsest * coarsest, bytes_of(coarsest_) + bytes_of(scratch_) + 2 * bytes_of(fields_.back().b)});
  return sizes;
}

std::size_t Hierarchy::bytes() const {
  std::size_t sum = 0;
  for (const LevelSize& size : sizes()) sum += size.bytes;
  return sum;
}

}  // namespace greenloop::offline
