#include "rt_tests/bench/exact_columns.hpp"

#include <cblas.h>

#include <Eigen/Cholesky>
#include <stdexcept>
#include <string>

namespace greenloop::bench {

ExactColumns::ExactColumns(const GreenStore& store, const std::vector<std::vector<Constraint>>& sets) {
  openblas_set_num_threads(1);
  const auto& contents = store.contents();
  for (std::size_t r = 0; r < contents.row_node.size(); ++r) {
    row_[static_cast<std::uint32_t>(contents.row_node[r])] = static_cast<Eigen::Index>(r);
  }
  std::map<std::uint32_t, int> column_of;
  for (std::size_t c = 0; c < contents.column_node.size(); ++c) {
    column_of[static_cast<std::uint32_t>(contents.column_node[c])] = static_cast<int>(c);
  }
  for (const auto& set : sets) {
    for (const Constraint& contact : set) {
      const auto found = column_of.find(contact.node);
      if (found == column_of.end()) {
        throw std::runtime_error(store.path().string() + ": node " + std::to_string(contact.node) +
                                 " of the model has no column here; is this the model's own store?");
      }
      if (columns_.find(contact.node) == columns_.end()) {
        Column column{store.read_columns(found->second, 1), {}};
        column.single = column.exact.cast<float>();
        columns_.emplace(contact.node, std::move(column));
      }
    }
  }
}

Solution ExactColumns::solve(const std::vector<Constraint>& set) const {
  const auto s = static_cast<Eigen::Index>(set.size());
  Eigen::MatrixXd capacitance(3 * s, 3 * s);
  Eigen::VectorXd held(3 * s);
  for (Eigen::Index j = 0; j < s; ++j) {
    const auto& contact = set[static_cast<std::size_t>(j)];
    const Eigen::MatrixXd& column = columns_.at(contact.node).exact;
    for (Eigen::Index i = 0; i < s; ++i) {
      capacitance.block<3, 3>(3 * i, 3 * j) = column.middleRows<3>(3 * row_.at(set[static_cast<std::size_t>(i)].node));
    }
    held.segment<3>(3 * j) = Eigen::Map<const Eigen::Vector3f>(contact.value).cast<double>();
  }
  Solution solution;
  solution.force = capacitance.llt().solve(held);
  solution.displacement = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(row_.size()));
  for (Eigen::Index j = 0; j < s; ++j) {
    const auto& column = columns_.at(set[static_cast<std::size_t>(j)].node).exact;
    solution.displacement += column * solution.force.segment<3>(3 * j);
  }
  return solution;
}

void ExactColumns::sum(const std::vector<Constraint>& set, const float* force, Eigen::VectorXf& field) const {
  field.setZero();
  const auto rows = static_cast<int>(field.size());
  for (std::size_t j = 0; j < set.size(); ++j) {
    const auto& column = columns_.at(set[j].node).single;
    cblas_sgemv(CblasColMajor, CblasNoTrans, rows, 3, 1.0F, column.data(), rows, force + 3 * j, 1, 1.0F, field.data(),
                1);
  }
}

}  // namespace greenloop::bench
