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
using Sphere = SyntheticSphere;

constexpr double range = 0.05;     // m, of the kernel
constexpr double softness = 1e-3;  // m/N
constexpr double twist = 0.5;

// The quantum of each layer over SyntheticOptions::quantum; of 16 bits over what holds the largest value. All differ,
// so that a reader that takes another layer's is found out.
constexpr double quantum_factor[layout::layers] = {1, 0.6, 0.28, 1.25};

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

void store(const Matrix3d& matrix, float (&six)[6]) {
  std::size_t k = 0;
  for (Index r = 0; r < 3; ++r) {
    for (Index c = r; c < 3; ++c) six[k++] = static_cast<float>(matrix(r, c));
  }
}

// Of the coefficients begin .. end-1.
ScalesData scales_of(const MatrixXd& form, Index begin, Index end) {
  const Eigen::Vector3d direction(1, -1, 0.5);
  ScalesData scales;
  for (Index i = begin; i < end; ++i) {
    const Matrix3d block = form.block<3, 3>(3 * i, 3 * i).selfadjointView<Eigen::Lower>();
    // a conditional compliance as if some neighbour were held along one direction; how many are is the writer's choice
    const Eigen::Vector3d held = block * direction;
    const Matrix3d conditional = 0.8 * (block - 0.5 / direction.dot(held) * held * held.transpose());
    const Matrix3d root = Eigen::SelfAdjointEigenSolver<Matrix3d>(conditional).operatorSqrt();
    layout::Scale<3> scale;
    store(root, scale.root);
    const Matrix3d inverse = symmetric_matrix(scale.root).inverse();
    store(inverse * block * inverse, scale.diagonal);
    scales.push_back(scale);
  }
  return scales;
}

double worst_column(const MatrixXd& decoded, const MatrixXd& exact) {
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

class Compression {
 public:
  Compression(ModelData& model, const SyntheticOptions& options) : model_(model), options_(options), wavelet_(model) {}

  void run(const MatrixXd& compliance) {
    MatrixXd form = compliance;
    to_wavelet_form(wavelet_, form);
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
      auto& scales = model_.levels[q].scales;
      scales = scales_of(form, wavelet_.begin(q), wavelet_.end(q));
      for (const layout::Scale<3>& scale : scales.of<3>())
        inverse_.emplace_back(symmetric_matrix(scale.root).inverse());
    }
    choose_quanta(form);
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) add_couplings(q, form);
    measure(form);
  }

 private:
  [[nodiscard]] Matrix3d scaled(const MatrixXd& form, Index i, Index j) const {
    return inverse_[i] * form.block<3, 3>(3 * i, 3 * j) * inverse_[j];
  }

  void choose_quanta(const MatrixXd& form) {
    double largest = 0;
    for (Index j = 0; j < wavelet_.end(wavelet_.levels() - 1); ++j) {
      for (Index i = 0; i < j; ++i) largest = std::max(largest, scaled(form, i, j).cwiseAbs().maxCoeff());
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const bool wide = layout::value_bits[layer] == 16;
      const double quantum = quantum_factor[layer] * (wide ? largest / 32767 : options_.quantum);
      model_.info.quantum[layer] = static_cast<float>(quantum);
    }
  }

  // the layer of fewest bits that holds the block
  [[nodiscard]] std::uint32_t layer_of(const Matrix3d& block) const {
    for (std::uint32_t layer = layout::layers; layer-- > 1;) {
      const double most = (1 << (layout::value_bits[layer] - 1)) - 1;
      if (block.cwiseAbs().maxCoeff() < most * double{model_.info.quantum[layer]}) return layer;
    }
    return 0;
  }

  void add_couplings(std::uint32_t q, const MatrixXd& form) {
    LevelData& level = model_.levels[q];
    for (CouplingsData& layer : level.couplings) layer.begin = {0};
    for (Index j = wavelet_.begin(q); j < wavelet_.end(q); ++j) {
      for (Index i = 0; i < j; ++i) {
        const Matrix3d block = scaled(form, i, j);
        if (block.norm() / std::sqrt(3.0) < options_.epsilon) continue;
        const std::uint32_t layer = layer_of(block);
        level.couplings[layer].index.push_back(static_cast<std::uint32_t>(i));
        for (Index k = 0; k < 9; ++k) {
          level.couplings[layer].value.push_back(
              static_cast<std::int16_t>(std::lround(block(k % 3, k / 3) / double{model_.info.quantum[layer]})));
        }
      }
      for (CouplingsData& layer : level.couplings) {
        layer.begin.push_back(static_cast<std::uint32_t>(layer.index.size()));
      }
    }
  }

  void measure(const MatrixXd& form) {
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
      const Index end = 3 * wavelet_.end(q);
      MatrixXd exact = form.topLeftCorner(end, end);
      from_wavelet_form(wavelet_, q, exact);
      const MatrixXd all = decoded_compliance(model_, q);
      ModelData cut = model_;
      cut.levels.resize(q + std::size_t{1});
      MatrixXd field = field_displacements(cut, q);
      layout::Level& counts = model_.levels[q].counts;
      counts.rms_error = static_cast<float>((all - exact).norm() / exact.norm());
      counts.worst_column_error = static_cast<float>(worst_column(all, exact));
      MatrixXd read = exact;
      for (Index node = 0; node < wavelet_.end(q); ++node) {
        if (is_read(cut, node)) continue;
        field.middleRows<3>(3 * node) = exact.middleRows<3>(3 * node);
        read.middleRows<3>(3 * node).setZero();
      }
      counts.field_rms_error = static_cast<float>((field - exact).norm() / read.norm());
      counts.field_column_error = static_cast<float>(worst_column(field, exact));
    }
  }

  // of a node by its place in the domain
  [[nodiscard]] bool is_read(const ModelData& cut, Index place) const {
    std::uint32_t q = 0;
    while (place >= wavelet_.end(q)) ++q;
    const auto i = static_cast<std::size_t>(place - wavelet_.begin(q));  // the domain comes first
    return (cut.levels[q].nodes[i].flags & layout::node_read) != 0;
  }

  ModelData& model_;
  const SyntheticOptions& options_;
  DenseWavelet wavelet_;
  std::vector<Matrix3d> inverse_;  // of every coefficient's root
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

// place of a node among the domain nodes
std::uint32_t domain_place(const Sphere& sphere, std::uint32_t node) {
  const auto domain = [&](std::uint32_t flags) { return (flags & layout::node_domain) != 0; };
  return static_cast<std::uint32_t>(std::count_if(sphere.flags.begin(), sphere.flags.begin() + node, domain));
}

// from the two ends of the edge and the corners across it, with 3x3 weights that differ a little from numbers; what is
// outside the domain weighs nothing
PredictionsData make_predictions(const Sphere& sphere, std::uint32_t q) {
  constexpr int half = 2048, spread = 401;
  PredictionsData predictions{.terms = 4, .index = {}, .weight = {}};
  for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
    if (!sphere.has(i, layout::node_domain)) continue;
    const auto& [a, b] = sphere.parents[i];
    const std::uint32_t* wing = sphere.stencils[i].wing;
    const std::array<std::uint32_t, 4> from = {a, b, wing[0], wing[1]};
    for (std::size_t k = 0; k < from.size(); ++k) {
      const bool inside = sphere.has(from[k], layout::node_domain);
      predictions.index.push_back(inside ? domain_place(sphere, from[k]) : 0);
      for (int e = 0; e < 9; ++e) {
        const int weight =
            (k < 2 && e % 4 == 0 ? half : 0) + static_cast<int>(37 * i + 11 * k) * (e + 1) % spread - spread / 2;
        predictions.weight.push_back(static_cast<std::int16_t>(inside ? weight : 0));
      }
    }
  }
  return predictions;
}

LevelData make_level(const Sphere& sphere, std::uint32_t q, layout::Wavelet wavelet) {
  constexpr layout::StencilRecord none{{layout::none, layout::none},
                                       {layout::none, layout::none, layout::none, layout::none}};
  LevelData level;
  const bool butterfly = layout::is_butterfly(wavelet);
  const auto lift = lifting_weights(sphere, butterfly);
  for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
    const Sphere::Point& x = sphere.positions[i];
    level.nodes.push_back({{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
                           static_cast<float>(sphere.areas[i]),
                           sphere.flags[i]});
    if (q == 0) continue;
    const double weight = layout::is_lifted(wavelet) ? 1 : 0;
    level.refinement.push_back({{sphere.parents[i][0], sphere.parents[i][1]},
                                {static_cast<float>(weight * lift[i][0]), static_cast<float>(weight * lift[i][1])}});
    if (!butterfly || !sphere.has(i, layout::node_domain)) continue;
    level.stencils.push_back(uses_stencil(sphere, i) ? sphere.stencils[i] : none);
  }
  if (q > 0 && wavelet == layout::Wavelet::equilibrated) level.predictions = make_predictions(sphere, q);
  return level;
}

}  // namespace

Matrix3d synthetic_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  Matrix3d core;
  core << 1, 0.2, 0.1, 0.2, 0.9, 0.15, 0.1, 0.15, 0.8;
  return softness * std::exp(-(x - y).norm() / range) * frame_at(x) * core * frame_at(y).transpose();
}

// vertices on the finest triangles, in turn, at places that differ
std::vector<layout::VertexRecord> vertex_map(const Sphere& sphere, std::uint32_t vertices) {
  std::vector<layout::VertexRecord> map;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const auto& [a, b, c] = sphere.finest[i % sphere.finest.size()];
    const float share = static_cast<float>(i % 8) / 8;
    map.push_back({{a, b, c}, {share, (1 - share) / 2, (1 - share) / 2}});
  }
  return map;
}

ModelData synthetic_model(const SyntheticOptions& options) {
  Sphere sphere = make_sphere(options.levels, options.touchable_above);
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    if (sphere.positions[i][2] < options.read_above * Sphere::radius) {
      sphere.flags[i] &= ~static_cast<std::uint32_t>(layout::node_read);
    }
  }
  ModelData model;
  model.info.problem = static_cast<std::uint32_t>(layout::Problem::elastostatic);
  model.info.wavelet = static_cast<std::uint32_t>(options.wavelet);
  model.info.components = 3;
  model.info.young = 1e5;
  model.info.poisson = 0.4;
  model.info.threshold = options.epsilon;
  model.info.rate = 1000;
  model.info.max_contacts = 16;
  model.info.step_work = 1'000'000;
  model.info.coarsest_constraint_level = options.coarsest_constraint_level;
  model.provenance = R"({"generator": "synthetic sphere"})";
  for (const auto& t : sphere.base) model.base_triangles.insert(model.base_triangles.end(), t.begin(), t.end());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    model.levels.push_back(make_level(sphere, q, options.wavelet));
    if (q >= options.coarsest_constraint_level) model.levels.back().representatives = representatives(sphere, q);
  }
  model.vertices = vertex_map(sphere, options.vertices);
  Compression compression(model, options);
  compression.run(exact_compliance(sphere));
  return model;
}

}  // namespace greenloop
