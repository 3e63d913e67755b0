#include "formats/testing/dense_wavelet.hpp"

#include <algorithm>

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

Matrix3d symmetric(const float (&six)[6]) {
  Matrix3d matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix;
}

Matrix3d matrix_of(const layout::Scale& scale) { return symmetric(scale.root); }

void add_diagonal(const std::vector<layout::Scale>& scales, Index first, MatrixXd& form) {
  for (Index i = 0; i < static_cast<Index>(scales.size()); ++i) {
    const Matrix3d root = matrix_of(scales[static_cast<std::size_t>(i)]);
    form.block<3, 3>(3 * (first + i), 3 * (first + i)) +=
        root * symmetric(scales[static_cast<std::size_t>(i)].diagonal) * root;
  }
}

void add_couplings(const CouplingsData& data, const std::vector<layout::Scale>& row_scales,
                   const std::vector<layout::Scale>& column_scales, Index first_row, Index first_column,
                   MatrixXd& form) {
  for (std::size_t j = 0; j + 1 < data.begin.size(); ++j) {
    for (std::size_t b = data.begin[j]; b < data.begin[j + 1]; ++b) {
      const std::size_t i = data.index.empty() ? b - data.begin[j] : data.index[b];
      Matrix3d block;
      for (Index k = 0; k < 9; ++k) block(k % 3, k / 3) = double{data.quantum} * data.value[9 * b + k];
      const Matrix3d unscaled = matrix_of(row_scales[i]) * block * matrix_of(column_scales[j]);
      form.block<3, 3>(3 * (first_column + static_cast<Index>(j)), 3 * (first_row + static_cast<Index>(i))) +=
          unscaled.transpose();
    }
  }
}

// the lower half of the non-standard form
MatrixXd stored_form(const ModelData& model, const DenseWavelet& wavelet, std::uint32_t layers) {
  const std::uint32_t levels = wavelet.levels();
  MatrixXd form = MatrixXd::Zero(3 * wavelet.end(levels - 1), 3 * wavelet.end(levels - 1));
  for (std::uint32_t q = 0; q < levels; ++q) {
    const LevelData& level = model.levels[q];
    const std::uint32_t averages = q < 2 ? 0 : q - 2;
    const auto& own = q == 0 ? level.averages : level.details;
    add_diagonal(own, wavelet.begin(q), form);
    for (std::uint32_t s = 0; s < layers; ++s) {
      const auto couplings = [&](layout::Partner partner) -> const CouplingsData& {
        return level.couplings[static_cast<std::size_t>(partner)][s];
      };
      add_couplings(couplings(layout::Partner::averages), model.levels[averages].averages, own, 0, wavelet.begin(q),
                    form);
      if (q > 0) {
        add_couplings(couplings(layout::Partner::parents), model.levels[q - 1].details, own, wavelet.begin(q - 1),
                      wavelet.begin(q), form);
      }
      add_couplings(couplings(layout::Partner::same), own, own, wavelet.begin(q), wavelet.begin(q), form);
    }
  }
  return form;
}

}  // namespace

DenseWavelet::DenseWavelet(const ModelData& model) {
  for (const LevelData& level : model.levels) {
    for (std::size_t i = 0; i < level.nodes.size(); ++i) {
      const bool domain = (level.nodes[i].flags & layout::node_domain) != 0;
      domain_index_.push_back(domain ? static_cast<Index>(odd_.size()) : -1);
      if (!domain) continue;
      Odd odd{{-1, -1}, {0, 0}};
      for (std::size_t k = 0; k < 2 && !level.refinement.empty(); ++k) {
        odd.parent[k] = domain_index_[level.refinement[i].parent[k]];
        odd.lift[k] = level.refinement[i].lift[k];
      }
      odd_.push_back(odd);
    }
    end_.push_back(static_cast<Index>(odd_.size()));
  }
}

// at(i): what stands at domain node i, a vector of some kind
template <class Vector>
void DenseWavelet::step_forward(std::uint32_t q, Vector at) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (const Index parent : odd_[m].parent) {
      if (parent >= 0) at(m) -= 0.5 * at(parent);
    }
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) at(odd_[m].parent[k]) += odd_[m].lift[k] * at(m);
    }
  }
}

template <class Vector>
void DenseWavelet::step_back(std::uint32_t q, Vector at) const {
  for (Index m = begin(q); m < end(q); ++m) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (odd_[m].parent[k] >= 0) at(odd_[m].parent[k]) -= odd_[m].lift[k] * at(m);
    }
  }
  for (Index m = begin(q); m < end(q); ++m) {
    for (const Index parent : odd_[m].parent) {
      if (parent >= 0) at(m) += 0.5 * at(parent);
    }
  }
}

void DenseWavelet::forward(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  for (Index j = 0; j < x.cols(); ++j) {
    step_forward(q, [&](Index i) { return x.col(j).segment<3>(3 * i); });
  }
}

void DenseWavelet::inverse(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  for (Index j = 0; j < x.cols(); ++j) {
    step_back(q, [&](Index i) { return x.col(j).segment<3>(3 * i); });
  }
}

void DenseWavelet::forward_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  step_forward(q, [&](Index i) { return x.middleCols<3>(3 * i); });
}

void DenseWavelet::inverse_columns(std::uint32_t q, Eigen::Ref<MatrixXd> x) const {
  step_back(q, [&](Index i) { return x.middleCols<3>(3 * i); });
}

std::vector<MatrixXd> to_non_standard_form(const DenseWavelet& wavelet, Eigen::Ref<MatrixXd> compliance) {
  std::vector<MatrixXd> averages(wavelet.levels() - 1);
  for (std::uint32_t q = wavelet.levels() - 1; q > 0; --q) {
    const Index begin = 3 * wavelet.begin(q), end = 3 * wavelet.end(q);
    wavelet.forward(q, compliance.topLeftCorner(end, end));
    wavelet.forward_columns(q, compliance.topLeftCorner(end, end));
    if (q > 1) wavelet.forward_columns(q - 1, compliance.block(begin, 0, end - begin, begin));
    averages[q - 1] = compliance.topLeftCorner(begin, begin);
  }
  return averages;
}

std::vector<MatrixXd> decoded_compliances(const ModelData& model, std::uint32_t layers) {
  const DenseWavelet wavelet(model);
  MatrixXd form = stored_form(model, wavelet, layers);
  std::vector<MatrixXd> result;
  for (std::uint32_t q = 0; q < wavelet.levels(); ++q) {
    const Index begin = 3 * wavelet.begin(q), end = 3 * wavelet.end(q);
    if (q > 1) wavelet.inverse_columns(q - 1, form.block(begin, 0, end - begin, begin));
    for (Index j = 0; j < end; ++j) {
      for (Index i = std::max(begin, j + 1); i < end; ++i) form(j, i) = form(i, j);
    }
    if (q > 0) {
      wavelet.inverse(q, form.topLeftCorner(end, end));
      wavelet.inverse_columns(q, form.topLeftCorner(end, end));
    }
    result.emplace_back(form.topLeftCorner(end, end));
  }
  return result;
}

MatrixXd decoded_compliance(const ModelData& model, std::uint32_t c, std::uint32_t layers) {
  return decoded_compliances(model, layers)[c];
}

}  // namespace greenloop
