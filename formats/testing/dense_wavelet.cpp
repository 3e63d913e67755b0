#include "formats/testing/dense_wavelet.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

// An element of a block, by its number in the file.
template <unsigned N, class Values>
Eigen::Matrix<double, N, N> block_of(const Values& values, std::size_t block, double unit) {
  Eigen::Matrix<double, N, N> matrix;
  for (Index k = 0; k < matrix.size(); ++k) {
    matrix(k % N, k / N) = unit * values[std::size_t{N} * N * block + static_cast<std::size_t>(k)];
  }
  return matrix;
}

// both halves of the wavelet form
template <unsigned N>
MatrixXd stored_form_of(const ModelData& model, const DenseWavelet& wavelet) {
  std::vector<Eigen::Matrix<double, N, N>> root;
  const Index rows = wavelet.rows(wavelet.levels() - 1);
  MatrixXd form = MatrixXd::Zero(rows, rows);
  const auto at = [&form](Index i, Index j) { return form.block<N, N>(N * i, N * j); };
  for (const LevelData& level : model.levels) {
    const auto first = static_cast<Index>(root.size());
    for (const layout::Scale<N>& own : level.scales.of<N>()) {
      const auto i = static_cast<Index>(root.size());
      root.push_back(symmetric_matrix(own.root));
      at(i, i) = root.back() * symmetric_matrix(own.diagonal) * root.back();
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsData& data = level.couplings[layer];
      for (Index j = 0; j + 1 < static_cast<Index>(data.begin.size()); ++j) {
        for (std::size_t b = data.begin[j]; b < data.begin[j + 1]; ++b) {
          const Index i = data.index[b], column = first + j;
          at(i, column) += root[i] * block_of<N>(data.value, b, model.info.quantum[layer]) * root[column];
          at(column, i) = at(i, column).transpose();
        }
      }
    }
  }
  return form;
}

MatrixXd stored_form(const ModelData& model, const DenseWavelet& wavelet) {
  return wavelet.components() == 1 ? stored_form_of<1>(model, wavelet) : stored_form_of<3>(model, wavelet);
}

// The rows of a matrix as vectors of N at the domain nodes, and what a weight makes of one.
template <unsigned N>
struct Rows {
  Eigen::Ref<MatrixXd>& matrix;

  auto at(Index i) { return matrix.middleRows<N>(N * i); }
  MatrixXd predicted(const Matrix3d& weight, Index i) { return weight.topLeftCorner<N, N>() * at(i); }
};

// Its columns as such vectors.
template <unsigned N>
struct Columns {
  Eigen::Ref<MatrixXd>& matrix;

  auto at(Index i) { return matrix.middleCols<N>(N * i); }
  MatrixXd predicted(const Matrix3d& weight, Index i) { return at(i) * weight.topLeftCorner<N, N>().transpose(); }
};

}  // namespace

Eigen::Matrix<double, 1, 1> symmetric_matrix(const float (&one)[1]) { return Eigen::Matrix<double, 1, 1>(one[0]); }

Matrix3d symmetric_matrix(const float (&six)[6]) {
  Matrix3d matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix;
}

DenseWavelet::DenseWavelet(const ModelData& model) : components_(model.info.components) {
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
    Matrix3d weight = Matrix3d::Zero();
    if (components_ == 1) {
      weight.topLeftCorner<1, 1>() = block_of<1>(predictions.weight, k, 1.0 / 4096);
    } else {
      weight = block_of<3>(predictions.weight, k, 1.0 / 4096);
    }
    odd.prediction.push_back({static_cast<Index>(predictions.index[k]), weight});
  }
}

template <class Vectors>
void DenseWavelet::step_forward(std::uint32_t q, Vectors x) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (const auto& [from, weight] : odd_[m].prediction) x.at(m) -= x.predicted(weight, from);
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) x.at(odd_[m].parent[k]) += odd_[m].lift[k] * x.at(m);
    }
  }
}

template <class Vectors>
void DenseWavelet::step_inverse(std::uint32_t q, Vectors x) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) x.at(odd_[m].parent[k]) -= odd_[m].lift[k] * x.at(m);
    }
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (const auto& [from, weight] : odd_[m].prediction) x.at(m) += x.predicted(weight, from);
  }
}

void DenseWavelet::forward(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  components_ == 1 ? step_forward(q, Rows<1>{x}) : step_forward(q, Rows<3>{x});
}

void DenseWavelet::inverse(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  components_ == 1 ? step_inverse(q, Rows<1>{x}) : step_inverse(q, Rows<3>{x});
}

void DenseWavelet::forward_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  components_ == 1 ? step_forward(q, Columns<1>{x}) : step_forward(q, Columns<3>{x});
}

void DenseWavelet::inverse_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  components_ == 1 ? step_inverse(q, Columns<1>{x}) : step_inverse(q, Columns<3>{x});
}

void to_wavelet_form(const DenseWavelet& wavelet, Eigen::Ref<MatrixXd> compliance) {
  for (std::uint32_t q = wavelet.levels() - 1; q > 0; --q) {
    const Index end = wavelet.rows(q);
    wavelet.forward(q, compliance.topRows(end));
    wavelet.forward_columns(q, compliance.leftCols(end));
  }
}

void from_wavelet_form(const DenseWavelet& wavelet, std::uint32_t c, Eigen::Ref<MatrixXd> form) {
  for (std::uint32_t q = 1; q <= c; ++q) {
    const Index end = wavelet.rows(q);
    wavelet.inverse(q, form.topRows(end));
    wavelet.inverse_columns(q, form.leftCols(end));
  }
}

MatrixXd decoded_compliance(const ModelData& model, std::uint32_t c) {
  const DenseWavelet wavelet(model);
  MatrixXd form = stored_form(model, wavelet);
  form.conservativeResize(wavelet.rows(c), wavelet.rows(c));
  from_wavelet_form(wavelet, c, form);
  return form;
}

MatrixXd field_displacements(const ModelData& model, std::uint32_t c) {
  const DenseWavelet wavelet(model);
  MatrixXd x = stored_form(model, wavelet).leftCols(wavelet.rows(c));
  for (std::uint32_t q = 1; q <= c; ++q) wavelet.inverse_columns(q, x.leftCols(wavelet.rows(q)));
  for (std::uint32_t q = 1; q < wavelet.levels(); ++q) wavelet.inverse(q, x.topRows(wavelet.rows(q)));
  return x;
}

}  // namespace greenloop
