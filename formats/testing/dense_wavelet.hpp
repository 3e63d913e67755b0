#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/write/writer.hpp"

namespace greenloop {

/// A matrix of layout::Scale<3>, or of Scale<1>.
[[nodiscard]] Eigen::Matrix3d symmetric_matrix(const float (&six)[6]);
[[nodiscard]] Eigen::Matrix<double, 1, 1> symmetric_matrix(const float (&one)[1]);

/// The wavelet transform of docs/theory.md on dense matrices over the domain nodes of a model, N = components() rows
/// and columns a node, coarse to fine. For tests only: plain and slow, to compare others with.
class DenseWavelet {
 public:
  /// Of the nodes, the refinement, the stencils and the predictions of `model`.
  explicit DenseWavelet(const ModelData& model);

  /// 1 or 3.
  [[nodiscard]] Eigen::Index components() const { return components_; }
  /// L + 1.
  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(end_.size()); }
  /// Domain nodes of K(q).
  [[nodiscard]] Eigen::Index end(std::uint32_t q) const { return end_[q]; }
  /// Rows and columns of those.
  [[nodiscard]] Eigen::Index rows(std::uint32_t q) const { return components_ * end_[q]; }
  /// Domain nodes of all levels coarser than q.
  [[nodiscard]] Eigen::Index begin(std::uint32_t q) const { return q == 0 ? 0 : end_[q - 1]; }
  /// The place of a node, given by its file index, in the domain; -1 outside.
  [[nodiscard]] Eigen::Index domain_index(std::uint32_t node) const { return domain_index_[node]; }

  /// x [rows(q) x k] -> T_q x: averages on K(q-1), then the details of level q. Work: 4 N end(q) k.
  void forward(std::uint32_t q, Eigen::Ref<Eigen::MatrixXd> x) const;
  /// x [rows(q) x k] -> T_q^-1 x.
  void inverse(std::uint32_t q, Eigen::Ref<Eigen::MatrixXd> x) const;
  /// x [k x rows(q)] -> x T_q^T.
  void forward_columns(std::uint32_t q, Eigen::Ref<Eigen::MatrixXd> x) const;
  /// x [k x rows(q)] -> x T_q^-T.
  void inverse_columns(std::uint32_t q, Eigen::Ref<Eigen::MatrixXd> x) const;

 private:
  struct Term {
    Eigen::Index from;       // place in the domain
    Eigen::Matrix3d weight;  // N x N of it
  };
  struct Odd {
    std::array<Eigen::Index, 2> parent;  // in the domain; -1 outside
    std::array<double, 2> lift;
    std::vector<Term> prediction;
  };
  void add_linear_prediction(const LevelData& level, std::size_t i, Odd& odd) const;
  void add_block_prediction(const PredictionsData& predictions, std::size_t domain_node, Odd& odd) const;
  template <class Vectors>
  void step_forward(std::uint32_t q, Vectors x) const;
  template <class Vectors>
  void step_inverse(std::uint32_t q, Vectors x) const;

  Eigen::Index components_;
  std::vector<Eigen::Index> end_;
  std::vector<Eigen::Index> domain_index_;
  std::vector<Odd> odd_;  // by domain index; unused on level 0
};

/// U of n domain nodes [N n x N n] -> W U W^T in place, the two-sided wavelet form of layout.hpp without scales. Work:
/// 10 (N n)^2 or so.
void to_wavelet_form(const DenseWavelet& wavelet, Eigen::Ref<Eigen::MatrixXd> compliance);

/// Its inverse on the coefficients of levels 0..c, [rows(c) x rows(c)]: the compliance between averages of level c.
void from_wavelet_form(const DenseWavelet& wavelet, std::uint32_t c, Eigen::Ref<Eigen::MatrixXd> form);

/// The compliance (m/N) between the averages of level `c` that a model stands for: N x N blocks over the domain nodes
/// of K(c). Work: as above.
[[nodiscard]] Eigen::MatrixXd decoded_compliance(const ModelData& model, std::uint32_t c);

/// The displacement of the domain per force on each domain node of K(c) that a model stands for: N domain x rows(c),
/// m/N. Work: as above.
[[nodiscard]] Eigen::MatrixXd field_displacements(const ModelData& model, std::uint32_t c);

}  // namespace greenloop
