#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "formats/testing/dense_wavelet.hpp"
#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/contact_set.hpp"

namespace greenloop {

/// T_q^-1 by its definition: from the averages of level q-1 and the details of level q to the averages of level q, as
/// many rows and columns a domain node as the model has components.
[[nodiscard]] Eigen::SparseMatrix<double> inverse_step(const ModelView& view, std::uint32_t q);

/// The compliances that a model stands for, as dense matrices in double precision: N rows and columns per domain node
/// of a model of N components, by place in the domain. For tests: plain and slow.
class DenseReference {
 public:
  explicit DenseReference(const ModelData& model);

  /// Between the averages of level c; m/N.
  [[nodiscard]] const Eigen::MatrixXd& compliance(std::uint32_t c) const { return compliance_[c]; }
  /// Of the averages of level c per force on the nodes of the finest level; m/N.
  [[nodiscard]] const Eigen::MatrixXd& finest_compliance(std::uint32_t c) const { return finest_compliance_[c]; }
  /// Displacement of the domain per force of level c: N domain by N |K(c)|.
  [[nodiscard]] const Eigen::MatrixXd& field(std::uint32_t c) const { return field_[c]; }
  /// Displacement of the domain per unit of each load, with details up to level q: 3 domain by loads.
  [[nodiscard]] Eigen::MatrixXd load_field(const ModelView& view, std::uint32_t q) const;
  /// The averages of level q of displacements of the domain.
  [[nodiscard]] Eigen::MatrixXd averages(std::uint32_t q, Eigen::MatrixXd x) const;

 private:
  DenseWavelet wavelet_;
  std::vector<Eigen::MatrixXd> compliance_;
  std::vector<Eigen::MatrixXd> finest_compliance_;
  std::vector<Eigen::MatrixXd> field_;
};

struct DenseAnswer {
  Eigen::VectorXd force;         ///< 3 per contact, N
  Eigen::VectorXd displacement;  ///< 3 per node, m
  double condition = 0;          ///< of the capacitance matrix
};

/// The capacitance matrix algorithm of an elastostatic model on dense matrices in double precision with a complete
/// factorisation; constraints of all kinds that Elastostatic knows, and loads of the model.
[[nodiscard]] DenseAnswer solve_dense(const ModelView& view, const DenseReference& reference, std::uint32_t level,
                                      std::span<const Constraint> constraints, const Elastostatic::Loads& loads = {});

}  // namespace greenloop
