#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "formats/store/green_store.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::bench {

/// Forces and field of one contact set.
struct Solution {
  Eigen::VectorXd force;         ///< [3 contacts] N
  Eigen::VectorXd displacement;  ///< [3 rows] m, rows of the store
};

/// What a program without compression keeps: the dense columns of the nodes it may need.
class ExactColumns {
 public:
  /// Reads the columns of every node of `sets` out of the store. Throws std::runtime_error if a node has none.
  ExactColumns(const GreenStore& store, const std::vector<std::vector<Constraint>>& sets);

  /// Solves the capacitance problem of a set and sums its columns, in double precision.
  [[nodiscard]] Solution solve(const std::vector<Constraint>& set) const;

  /// field = the sum of a set's columns for these forces, in single precision by OpenBLAS: one sgemv a contact.
  void sum(const std::vector<Constraint>& set, const float* force, Eigen::VectorXf& field) const;

 private:
  struct Column {
    Eigen::MatrixXd exact;   ///< 3 rows x 3
    Eigen::MatrixXf single;  ///< the same, for sum
  };
  std::map<std::uint32_t, Column> columns_;
  std::map<std::uint32_t, Eigen::Index> row_;
};

/// Seconds of processor time, on one thread, of one back-substitution with the stiffness matrix's Cholesky factor,
/// median of several.
struct BackSubstitution {
  double seconds = 0;
  const char* solver = "";
};
[[nodiscard]] BackSubstitution time_back_substitution(const GreenStore& store);

}  // namespace greenloop::bench
