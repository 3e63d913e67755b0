#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop {

/// The columns that a file holds for constraint level c, decoded and inverse transformed in double precision straight
/// from the definition: 3 * nodes by 3 * columns, m/N.
[[nodiscard]] Eigen::MatrixXd decode_columns(const ModelView& view, std::uint32_t c);

struct DenseAnswer {
  Eigen::VectorXd force;         ///< 3 per contact, N
  Eigen::VectorXd displacement;  ///< 3 per node, m
  double condition = 0;          ///< of the capacitance matrix
};

/// The capacitance matrix algorithm on decoded columns, in double precision with a complete factorisation.
[[nodiscard]] DenseAnswer solve_dense(const ModelView& view, std::uint32_t c, const Eigen::MatrixXd& columns,
                                      std::span<const Contact> contacts);

}  // namespace greenloop
