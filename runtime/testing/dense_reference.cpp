#include "runtime/testing/dense_reference.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <map>

namespace greenloop {
namespace {

std::uint32_t row_of(const BlocksView& blocks, std::uint32_t column, std::uint32_t b) {
  if (blocks.index_bytes == 0) {
    return b - blocks.begin[column];
  }
  return blocks.index_bytes == 2 ? static_cast<const std::uint16_t*>(blocks.index)[b]
                                 : static_cast<const std::uint32_t*>(blocks.index)[b];
}

double value_of(const BlocksView& blocks, std::size_t k) {
  return blocks.value_bytes == 1 ? static_cast<const std::int8_t*>(blocks.value)[k]
                                 : static_cast<const std::int16_t*>(blocks.value)[k];
}

void scatter(const ModelView& view, std::uint32_t c, std::uint32_t column, Eigen::MatrixXd& x) {
  for (std::uint32_t r = 0; r < view.levels; ++r) {
    const BlocksView& blocks = view.blocks[c][r];
    for (std::uint32_t b = blocks.begin[column]; b < blocks.begin[column + 1]; ++b) {
      const Eigen::Index node = view.level[r].node_begin + row_of(blocks, column, b);
      for (std::uint32_t k = 0; k < 9; ++k) {
        x(3 * node + k % 3, Eigen::Index{3} * column + k / 3) =
            blocks.scale[column] * value_of(blocks, std::size_t{9} * b + k);
      }
    }
  }
}

void invert_level(const LevelView& level, Eigen::MatrixXd& x) {
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    for (std::uint32_t side = 0; side < 2; ++side) {
      x.middleRows<3>(Eigen::Index{3} * level.refinement[i].parent[side]) -=
          double{level.refinement[i].lift[side]} * x.middleRows<3>(Eigen::Index{3} * (level.node_begin + i));
    }
  }
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    const std::uint32_t* parent = level.refinement[i].parent;
    x.middleRows<3>(Eigen::Index{3} * (level.node_begin + i)) +=
        0.5 * (x.middleRows<3>(Eigen::Index{3} * parent[0]) + x.middleRows<3>(Eigen::Index{3} * parent[1]));
  }
}

std::uint32_t representative(const ModelView& view, std::uint32_t c, std::uint32_t node) {
  std::uint32_t q = 0;
  while (node >= view.level[q].node_begin + view.level[q].counts->node_count) {
    ++q;
  }
  return view.representatives[c][q][node - view.level[q].node_begin];
}

}  // namespace

Eigen::MatrixXd decode_columns(const ModelView& view, std::uint32_t c) {
  const std::uint32_t columns = view.level[c].counts->column_count;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(Eigen::Index{3} * view.node_count, Eigen::Index{3} * columns);
  for (std::uint32_t j = 0; j < columns; ++j) {
    scatter(view, c, j, x);
  }
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    invert_level(view.level[q], x);
  }
  return x;
}

DenseAnswer solve_dense(const ModelView& view, std::uint32_t c, const Eigen::MatrixXd& columns,
                        std::span<const Contact> contacts) {
  std::map<std::uint32_t, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    members[representative(view, c, contacts[i].node)].push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(members.size());
  Eigen::MatrixXd capacitance(3 * n, 3 * n);
  Eigen::MatrixXd used(columns.rows(), 3 * n);
  Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(3 * n);
  Eigen::Index j = 0;
  for (const auto& [column, of_column] : members) {
    used.middleCols<3>(3 * j) = columns.middleCols<3>(Eigen::Index{3} * column);
    for (const std::size_t i : of_column) {
      for (Eigen::Index r = 0; r < 3; ++r) {
        prescribed(3 * j + r) += double{contacts[i].displacement[r]} / static_cast<double>(of_column.size());
      }
    }
    ++j;
  }
  Eigen::Index i = 0;
  for (const auto& [column, of_column] : members) {
    capacitance.middleRows<3>(3 * i++) = used.middleRows<3>(Eigen::Index{3} * view.level[c].columns[column].node);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(capacitance);
  const Eigen::VectorXd force = capacitance.fullPivLu().solve(prescribed);
  DenseAnswer answer{Eigen::VectorXd(3 * contacts.size()), used * force,
                     svd.singularValues().maxCoeff() / svd.singularValues().minCoeff()};
  j = 0;
  for (const auto& [column, of_column] : members) {
    for (const std::size_t k : of_column) {
      answer.force.segment<3>(3 * static_cast<Eigen::Index>(k)) =
          force.segment<3>(3 * j) / static_cast<double>(of_column.size());
    }
    ++j;
  }
  return answer;
}

}  // namespace greenloop
