#include "formats/testing/synthetic_model.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "formats/testing/dense_wavelet.hpp"
#include "formats/testing/synthetic_sphere.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using layout::Partner;
using Sphere = SyntheticSphere;

constexpr double range = 0.05;     // m, of the kernel
constexpr double softness = 1e-3;  // m/N
constexpr double twist = 0.5;

// I + twist [x / radius]_x
Matrix3d frame_at(const Eigen::Vector3d& x) {
  const Eigen::Vector3d t = twist / Sphere::radius * x;
  Matrix3d frame;
  frame << 1, -t[2], t[1], t[2], 1, -t[0], -t[1], t[0], 1;
  return frame;
}

MatrixXd exact_compliance(const Sphere& sphere) {
  std::vector<Eigen::Vector3d> domain;
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    const auto& x = sphere.positions[i];
    if (sphere.has(i, layout::node_domain)) domain.emplace_back(x[0], x[1], x[2]);
  }
  const auto n = static_cast<Index>(domain.size());
  MatrixXd compliance(3 * n, 3 * n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      compliance.block<3, 3>(3 * i, 3 * j) = synthetic_compliance(domain[i], domain[j]);
    }
  }
  return compliance;
}

Matrix3d symmetric(const float (&six)[6]) {
  Matrix3d matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix;
}

void store(const Matrix3d& matrix, float (&six)[6]) {
  std::size_t k = 0;
  for (Index r = 0; r < 3; ++r) {
    for (Index c = r; c < 3; ++c) six[k++] = static_cast<float>(matrix(r, c));
  }
}

// Of the coefficients begin .. end-1, whose diagonal blocks stand in `blocks`.
std::vector<layout::Scale> scales_of(const MatrixXd& blocks, Index begin, Index end) {
  const Eigen::Vector3d direction(1, -1, 0.5);
  std::vector<layout::Scale> scales;
  for (Index i = begin; i < end; ++i) {
    const Matrix3d block = blocks.block<3, 3>(3 * i, 3 * i).selfadjointView<Eigen::Lower>();
    // a conditional compliance as if some neighbour were held along one direction; how many are is the writer's choice
    const Eigen::Vector3d held = block * direction;
    const Matrix3d conditional = 0.8 * (block - 0.5 / direction.dot(held) * held * held.transpose());
    const Matrix3d root = Eigen::SelfAdjointEigenSolver<Matrix3d>(conditional).operatorSqrt();
    layout::Scale scale;
    store(root, scale.root);
    const Matrix3d inverse = symmetric(scale.root).inverse();
    store(inverse * block * inverse, scale.diagonal);
    scales.push_back(scale);
  }
  return scales;
}

std::vector<Matrix3d> inverse_roots(const std::vector<layout::Scale>& scales) {
  std::vector<Matrix3d> inverses;
  inverses.reserve(scales.size());
  for (const layout::Scale& scale : scales) inverses.emplace_back(symmetric(scale.root).inverse());
  return inverses;
}

// One partner's couplings before they are quantised.
struct ScaledBlocks {
  std::vector<std::uint32_t> begin = {0}, index;
  std::vector<float> value;

  void add(std::uint32_t row, const Matrix3d& block) {
    index.push_back(row);
    for (Index k = 0; k < 9; ++k) value.push_back(static_cast<float>(block(k % 3, k / 3)));
  }
  void end_column() { begin.push_back(static_cast<std::uint32_t>(index.size())); }

  [[nodiscard]] CouplingsData quantised(std::uint32_t bits) const {
    float largest = 0;
    for (const float x : value) largest = std::max(largest, std::abs(x));
    const auto most = static_cast<float>((1 << (bits - 1)) - 1);
    CouplingsData data{.value_bits = bits, .quantum = largest / most, .begin = begin, .index = index, .value = {}};
    for (const float x : value) {
      data.value.push_back(static_cast<std::int16_t>(std::clamp(std::round(x / data.quantum), -most, most)));
    }
    return data;
  }
};

class Compression {
 public:
  Compression(ModelData& model, const SyntheticOptions& options) : model_(model), options_(options), wavelet_(model) {}

  void run(MatrixXd compliance) {
    exact_ = to_non_standard_form(wavelet_, compliance);
    const std::uint32_t levels = wavelet_.levels();
    for (std::uint32_t q = 0; q < levels; ++q) {
      LevelData& level = model_.levels[q];
      if (q == 0) level.averages = scales_of(compliance, 0, wavelet_.end(0));
      if (q > 0) level.details = scales_of(compliance, wavelet_.begin(q), wavelet_.end(q));
      if (q > 0 && q + 2 < levels) level.averages = scales_of(exact_[q], 0, wavelet_.end(q));
    }
    for (std::uint32_t q = 0; q < levels; ++q) add_couplings(q, compliance);
  }

  void measure(const Sphere& sphere) {
    exact_.push_back(exact_compliance(sphere));
    for (std::uint32_t layers = layout::strengths; layers >= options_.field_layers; --layers) {
      const std::vector<MatrixXd> decoded = decoded_compliances(model_, layers);
      for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
        layout::Level& counts = model_.levels[q].counts;
        counts.field_rms_error = static_cast<float>((decoded[q] - exact_[q]).norm() / exact_[q].norm());
        counts.field_column_error = static_cast<float>(worst_column(decoded[q], exact_[q]));
        if (layers < layout::strengths) continue;
        counts.rms_error = counts.field_rms_error;
        counts.worst_column_error = counts.field_column_error;
      }
    }
  }

 private:
  static double worst_column(const MatrixXd& decoded, const MatrixXd& exact) {
    double worst = 0;
    for (Index j = 0; j < exact.cols(); j += 3) {
      double largest_error = 0, largest = 0;
      for (Index i = 0; i < exact.rows(); i += 3) {
        largest = std::max(largest, exact.block<3, 3>(i, j).norm());
        largest_error = std::max(largest_error, (decoded.block<3, 3>(i, j) - exact.block<3, 3>(i, j)).norm());
      }
      worst = std::max(worst, largest_error / largest);
    }
    return worst;
  }

  [[nodiscard]] std::size_t layer_of(double norm) const {
    return norm >= options_.strong ? 0 : norm >= options_.medium ? 1 : 2;
  }

  void add_couplings(std::uint32_t q, const MatrixXd& form) {
    const auto& own = q == 0 ? model_.levels[0].averages : model_.levels[q].details;
    if (q > 0) add_couplings(q, Partner::averages, model_.levels[q < 2 ? 0 : q - 2].averages, own, 0, form);
    if (q > 1) add_couplings(q, Partner::parents, model_.levels[q - 1].details, own, wavelet_.begin(q - 1), form);
    add_couplings(q, Partner::same, own, own, wavelet_.begin(q), form);
  }

  void add_couplings(std::uint32_t q, Partner partner, const std::vector<layout::Scale>& row_scales,
                     const std::vector<layout::Scale>& column_scales, Index first_row, const MatrixXd& form) {
    const auto rows = inverse_roots(row_scales), columns = inverse_roots(column_scales);
    ScaledBlocks layers[layout::strengths];
    for (std::size_t j = 0; j < columns.size(); ++j) {
      for (std::size_t i = 0; i < (partner == Partner::same ? j : rows.size()); ++i) {
        const Index column = 3 * (wavelet_.begin(q) + static_cast<Index>(j));
        const Index row = 3 * (first_row + static_cast<Index>(i));
        const Matrix3d block = rows[i] * form.block<3, 3>(column, row).transpose() * columns[j];
        const double norm = block.norm() / std::sqrt(3.0);
        if (q > 0 && norm < options_.epsilon) continue;
        layers[q == 0 ? 0 : layer_of(norm)].add(static_cast<std::uint32_t>(i), block);
      }
      for (ScaledBlocks& layer : layers) layer.end_column();
    }
    auto& stored = model_.levels[q].couplings[static_cast<std::size_t>(partner)];
    if (q == 0) {
      stored[0] = layers[0].quantised(16);
      stored[0].index.clear();
    } else {
      stored[0] = layers[0].quantised(options_.strong_bits);
      stored[1] = layers[1].quantised(options_.medium_bits);
      stored[2] = layers[2].quantised(options_.weak_bits);
    }
  }

  ModelData& model_;
  const SyntheticOptions& options_;
  DenseWavelet wavelet_;
  std::vector<MatrixXd> exact_;  // by level
};

std::vector<std::vector<std::uint32_t>> representatives(const Sphere& sphere, std::uint32_t c) {
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < sphere.begin[c + 1]; ++i) {
    if (sphere.has(i, layout::node_touchable)) candidates.push_back(i);
  }
  std::vector<std::vector<std::uint32_t>> result(sphere.levels());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
      const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
        return distance(sphere.positions[a], sphere.positions[i]) < distance(sphere.positions[b], sphere.positions[i]);
      };
      const bool touchable = sphere.has(i, layout::node_touchable);
      result[q].push_back(touchable ? *std::min_element(candidates.begin(), candidates.end(), nearer) : layout::none);
    }
  }
  return result;
}

LevelData make_level(const Sphere& sphere, std::uint32_t q, bool lifted) {
  LevelData level;
  const auto lift = lifting_weights(sphere);
  for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
    const Sphere::Point& x = sphere.positions[i];
    level.nodes.push_back({{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
                           static_cast<float>(sphere.areas[i]),
                           sphere.flags[i]});
    if (q == 0) continue;
    const double weight = lifted ? 1 : 0;
    level.refinement.push_back({{sphere.parents[i][0], sphere.parents[i][1]},
                                {static_cast<float>(weight * lift[i][0]), static_cast<float>(weight * lift[i][1])}});
  }
  return level;
}

}  // namespace

Matrix3d synthetic_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  Matrix3d core;
  core << 1, 0.2, 0.1, 0.2, 0.9, 0.15, 0.1, 0.15, 0.8;
  return softness * std::exp(-(x - y).norm() / range) * frame_at(x) * core * frame_at(y).transpose();
}

ModelData synthetic_model(const SyntheticOptions& options) {
  const Sphere sphere = make_sphere(options.levels, options.touchable_above);
  ModelData model;
  model.info.problem = static_cast<std::uint32_t>(layout::Problem::elastostatic);
  model.info.wavelet =
      static_cast<std::uint32_t>(options.lifted ? layout::Wavelet::lifted_linear : layout::Wavelet::linear);
  model.info.components = 3;
  model.info.young = 1e5;
  model.info.poisson = 0.4;
  model.info.threshold = options.epsilon;
  model.info.rate = 1000;
  model.info.max_contacts = 16;
  model.info.step_work = 1'000'000;
  model.info.coarsest_constraint_level = options.coarsest_constraint_level;
  model.info.field_layers = options.field_layers;
  model.provenance = R"({"generator": "synthetic sphere"})";
  for (const auto& t : sphere.base) model.base_triangles.insert(model.base_triangles.end(), t.begin(), t.end());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    model.levels.push_back(make_level(sphere, q, options.lifted));
    if (q >= options.coarsest_constraint_level) model.levels.back().representatives = representatives(sphere, q);
  }
  Compression compression(model, options);
  compression.run(exact_compliance(sphere));
  compression.measure(sphere);
  return model;
}

}  // namespace greenloop
