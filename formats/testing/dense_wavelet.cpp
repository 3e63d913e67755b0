#include "formats/testing/dense_wavelet.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

// both halves of the wavelet form
MatrixXd stored_form(const ModelData& model, const DenseWavelet& wavelet) {
  std::vector<Matrix3d> root;
  const Index rows = 3 * wavelet.end(wavelet.levels() - 1);
  MatrixXd form = MatrixXd::Zero(rows, rows);
  for (const LevelData& level : model.levels) {
    const auto first = static_cast<Index>(root.size());
    for (const layout::Scale<3>& own : level.scales.of<3>()) {
      const auto i = static_cast<Index>(root.size());
      root.push_back(symmetric_matrix(own.root));
      form.block<3, 3>(3 * i, 3 * i) = root.back() * symmetric_matrix(own.diagonal) * root.back();
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsData& data = level.couplings[layer];
      for (Index j = 0; j + 1 < static_cast<Index>(data.begin.size()); ++j) {
        for (std::size_t b = data.begin[j]; b < data.begin[j + 1]; ++b) {
          const Index i = data.index[b], column = first + j;
          Matrix3d block;
          for (Index k = 0; k < 9; ++k) {
            block(k % 3, k / 3) = double{model.info.quantum[layer]} * data.value[9 * b + static_cast<std::size_t>(k)];
          }
          form.block<3, 3>(3 * i, 3 * column) += root[i] * block * root[column];
          form.block<3, 3>(3 * column, 3 * i) = form.block<3, 3>(3 * i, 3 * column).transpose();
        }
      }
    }
  }
  return form;
}

}  // namespace

Matrix3d symmetric_matrix(const float (&six)[6]) {
  Matrix3d matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix;
}

DenseWavelet::DenseWavelet(const ModelData& model) {
  for (const LevelData& level : model.levels) {
    std::size_t domain_node = 0;
    for (std::size_t i = 0; i < level.nodes.size(); ++i) {
      const bool domain = (level.nodes[i].flags & layout::node_domain) != 0;
      domain_index_.push_back(domain ? static_cast<Index>(odd_.size()) : -1);
      if (!domain) continue;
      Odd odd{{-1, -1}, {0, 0}, {}};
      for (std::size_t k = 0; k < 2 && !level.refinement.empty(); ++k) {
        odd.parent[k] = domain_index_[level.refinement[i].parent[k]];
        odd.lift[k] = level.refinement[i].lift[k];
      }
      if (static_cast<layout::Wavelet>(model.info.wavelet) == layout::Wavelet::equilibrated) {
        add_block_prediction(level.predictions, domain_node++, odd);
      } else if (!level.refinement.empty()) {
        add_linear_prediction(level, i, odd);
      }
      odd_.push_back(odd);
    }
    end_.push_back(static_cast<Index>(odd_.size()));
  }
}

// linear, or by the Butterfly stencil
void DenseWavelet::add_linear_prediction(const LevelData& level, std::size_t i, Odd& odd) const {
  const auto add_term = [&](std::uint32_t node, double weight) {
    if (domain_index_[node] >= 0) odd.prediction.push_back({domain_index_[node], weight * Matrix3d::Identity()});
  };
  for (const std::uint32_t node : level.refinement[i].parent) add_term(node, 0.5);
  if (level.stencils.empty() || level.stencils[i].wing[0] == layout::none) return;
  for (const std::uint32_t node : level.stencils[i].wing) add_term(node, 1.0 / 8);
  for (const std::uint32_t node : level.stencils[i].outer) add_term(node, -1.0 / 16);
}

void DenseWavelet::add_block_prediction(const PredictionsData& predictions, std::size_t domain_node, Odd& odd) const {
  for (std::size_t k = predictions.terms * domain_node; k < predictions.terms * (domain_node + 1); ++k) {
    Matrix3d weight;
    for (Index e = 0; e < 9; ++e)
      weight(e % 3, e / 3) = predictions.weight[9 * k + static_cast<std::size_t>(e)] / 4096.0;
    odd.prediction.push_back({static_cast<Index>(predictions.index[k]), weight});
  }
}

// at(i): what stands at domain node i, three rows or three columns; predicted(weight, i): what a weight makes of it
template <class Vector, class Predict>
void DenseWavelet::step_forward(std::uint32_t q, Vector at, Predict predicted) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (const auto& [from, weight] : odd_[m].prediction) at(m) -= predicted(weight, from);
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) at(odd_[m].parent[k]) += odd_[m].lift[k] * at(m);
    }
  }
}

template <class Vector, class Predict>
void DenseWavelet::step_inverse(std::uint32_t q, Vector at, Predict predicted) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) at(odd_[m].parent[k]) -= odd_[m].lift[k] * at(m);
    }
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (const auto& [from, weight] : odd_[m].prediction) at(m) += predicted(weight, from);
  }
}

void DenseWavelet::forward(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  const auto at = [&](Index i) { return x.middleRows<3>(3 * i); };
  step_forward(q, at, [&](const Matrix3d& weight, Index i) -> MatrixXd { return weight * at(i); });
}

void DenseWavelet::inverse(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  const auto at = [&](Index i) { return x.middleRows<3>(3 * i); };
  step_inverse(q, at, [&](const Matrix3d& weight, Index i) -> MatrixXd { return weight * at(i); });
}

void DenseWavelet::forward_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  const auto at = [&](Index i) { return x.middleCols<3>(3 * i); };
  step_forward(q, at, [&](const Matrix3d& weight, Index i) -> MatrixXd { return at(i) * weight.transpose(); });
}

void DenseWavelet::inverse_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  const auto at = [&](Index i) { return x.middleCols<3>(3 * i); };
  step_inverse(q, at, [&](const Matrix3d& weight, Index i) -> MatrixXd { return at(i) * weight.transpose(); });
}

void to_wavelet_form(const DenseWavelet& wavelet, Eigen::Ref<MatrixXd> compliance) {
  for (std::uint32_t q = wavelet.levels() - 1; q > 0; --q) {
    const Index end = 3 * wavelet.end(q);
    wavelet.forward(q, compliance.topRows(end));
    wavelet.forward_columns(q, compliance.leftCols(end));
  }
}

void from_wavelet_form(const DenseWavelet& wavelet, std::uint32_t c, Eigen::Ref<MatrixXd> form) {
  for (std::uint32_t q = 1; q <= c; ++q) {
    const Index end = 3 * wavelet.end(q);
    wavelet.inverse(q, form.topRows(end));
    wavelet.inverse_columns(q, form.leftCols(end));
  }
}

MatrixXd decoded_compliance(const ModelData& model, std::uint32_t c) {
  const DenseWavelet wavelet(model);
  MatrixXd form = stored_form(model, wavelet);
  form.conservativeResize(3 * wavelet.end(c), 3 * wavelet.end(c));
  from_wavelet_form(wavelet, c, form);
  return form;
}

MatrixXd field_displacements(const ModelData& model, std::uint32_t c) {
  const DenseWavelet wavelet(model);
  MatrixXd x = stored_form(model, wavelet).leftCols(3 * wavelet.end(c));
  for (std::uint32_t q = 1; q <= c; ++q) wavelet.inverse_columns(q, x.leftCols(3 * wavelet.end(q)));
  for (std::uint32_t q = 1; q < wavelet.levels(); ++q) wavelet.inverse(q, x.topRows(3 * wavelet.end(q)));
  return x;
}

}  // namespace greenloop
