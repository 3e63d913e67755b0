#include "formats/testing/synthetic_model.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "formats/testing/dense_wavelet.hpp"
#include "formats/testing/synthetic_sphere.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
template <unsigned N>
using Block = Eigen::Matrix<double, N, N>;
using Sphere = SyntheticSphere;

constexpr double range = 0.05;     // m, of the kernel
constexpr double softness = 1e-3;  // m/N, or of a scalar problem's units
constexpr double twist = 0.5;
constexpr double area_density = 100;  // kg/m^2, of what gravity pulls

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

template <unsigned N>
Block<N> exact_block(const Eigen::Vector3d& x, const Eigen::Vector3d& y);
template <>
Block<1> exact_block<1>(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  return Block<1>(synthetic_scalar_compliance(x, y));
}
template <>
Block<3> exact_block<3>(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  return synthetic_compliance(x, y);
}

template <unsigned N>
MatrixXd exact_compliance(const Sphere& sphere) {
  std::vector<Eigen::Vector3d> domain;
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    const auto& x = sphere.positions[i];
    if (sphere.has(i, layout::node_domain)) domain.emplace_back(x[0], x[1], x[2]);
  }
  const auto n = static_cast<Index>(domain.size());
  MatrixXd compliance(N * n, N * n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      compliance.block<N, N>(N * i, N * j) = exact_block<N>(domain[i], domain[j]);
    }
  }
  return compliance;
}

template <unsigned N>
void store(const Block<N>& matrix, float (&upper)[N * (N + 1) / 2]) {
  std::size_t k = 0;
  for (Index r = 0; r < Index{N}; ++r) {
    for (Index c = r; c < Index{N}; ++c) upper[k++] = static_cast<float>(matrix(r, c));
  }
}

// Of the coefficients begin .. end-1.
template <unsigned N>
ScalesData scales_of(const MatrixXd& form, Index begin, Index end) {
  const Eigen::Matrix<double, N, 1> direction = Eigen::Vector3d(1, -1, 0.5).head<N>();
  ScalesData scales;
  for (Index i = begin; i < end; ++i) {
    const Block<N> block = form.block<N, N>(N * i, N * i).template selfadjointView<Eigen::Lower>();
    // a conditional compliance as if some neighbour were held along one direction; how many are is the writer's choice
    const Eigen::Matrix<double, N, 1> held = block * direction;
    const Block<N> conditional = 0.8 * (block - 0.5 / direction.dot(held) * held * held.transpose());
    const Block<N> root = Eigen::SelfAdjointEigenSolver<Block<N>>(conditional).operatorSqrt();
    layout::Scale<N> scale;
    store<N>(root, scale.root);
    const Block<N> inverse = symmetric_matrix(scale.root).inverse();
    store<N>(inverse * block * inverse, scale.diagonal);
    scales.push_back(scale);
  }
  return scales;
}

template <unsigned N>
double worst_column(const MatrixXd& decoded, const MatrixXd& exact) {
  double worst = 0;
  for (Index j = 0; j < exact.cols(); j += N) {
    double largest_error = 0, largest = 0;
    for (Index i = 0; i < exact.rows(); i += N) {
      largest = std::max(largest, exact.block<N, N>(i, j).norm());
      largest_error = std::max(largest_error, (decoded.block<N, N>(i, j) - exact.block<N, N>(i, j)).norm());
    }
    worst = std::max(worst, largest_error / largest);
  }
  return worst;
}

template <unsigned N>
class Compression {
 public:
  Compression(ModelData& model, const SyntheticOptions& options) : model_(model), options_(options), wavelet_(model) {}

  void run(const MatrixXd& compliance) {
    MatrixXd form = compliance;
    to_wavelet_form(wavelet_, form);
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
      auto& scales = model_.levels[q].scales;
      scales = scales_of<N>(form, wavelet_.begin(q), wavelet_.end(q));
      for (const layout::Scale<N>& scale : scales.template of<N>())
        inverse_.emplace_back(symmetric_matrix(scale.root).inverse());
    }
    choose_quanta(form);
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) add_couplings(q, form);
    measure(form);
  }

  // of forces (N) a unit of each load, [3 domain x loads]
  void add_loads(const MatrixXd& compliance, const MatrixXd& forces) {
    MatrixXd columns = compliance * forces;
    for (std::uint32_t q = wavelet_.levels(); q-- > 1;) wavelet_.forward(q, columns.topRows(wavelet_.rows(q)));
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
      const Index begin = 3 * wavelet_.begin(q);
      const MatrixXd own = columns.middleRows(begin, wavelet_.rows(q) - begin);
      model_.levels[q].load_columns.assign(own.data(), own.data() + own.size());
    }
  }

 private:
  [[nodiscard]] Block<N> scaled(const MatrixXd& form, Index i, Index j) const {
    return inverse_[i] * form.block<N, N>(N * i, N * j) * inverse_[j];
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
  [[nodiscard]] std::uint32_t layer_of(const Block<N>& block) const {
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
        const Block<N> block = scaled(form, i, j);
        if (block.norm() / std::sqrt(double{N}) < options_.epsilon) continue;
        const std::uint32_t layer = layer_of(block);
        level.couplings[layer].index.push_back(static_cast<std::uint32_t>(i));
        for (Index k = 0; k < block.size(); ++k) {
          level.couplings[layer].value.push_back(
              static_cast<std::int16_t>(std::lround(block(k % N, k / N) / double{model_.info.quantum[layer]})));
        }
      }
      for (CouplingsData& layer : level.couplings) {
        layer.begin.push_back(static_cast<std::uint32_t>(layer.index.size()));
      }
    }
  }

  void measure(const MatrixXd& form) {
    for (std::uint32_t q = 0; q < wavelet_.levels(); ++q) {
      const Index end = wavelet_.rows(q);
      MatrixXd exact = form.topLeftCorner(end, end);
      from_wavelet_form(wavelet_, q, exact);
      const MatrixXd all = decoded_compliance(model_, q);
      ModelData cut = model_;
      cut.levels.resize(q + std::size_t{1});
      MatrixXd field = field_displacements(cut, q);
      layout::Level& counts = model_.levels[q].counts;
      counts.rms_error = static_cast<float>((all - exact).norm() / exact.norm());
      counts.worst_column_error = static_cast<float>(worst_column<N>(all, exact));
      MatrixXd read = exact;
      for (Index node = 0; node < wavelet_.end(q); ++node) {
        if (is_read(cut, node)) continue;
        field.middleRows<N>(N * node) = exact.middleRows<N>(N * node);
        read.middleRows<N>(N * node).setZero();
      }
      counts.field_rms_error = static_cast<float>((field - exact).norm() / read.norm());
      counts.field_column_error = static_cast<float>(worst_column<N>(field, exact));
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
  std::vector<Block<N>> inverse_;  // of every coefficient's root
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

// from the two ends of the edge and the corners across it, with weights that differ a little from numbers; what is
// outside the domain weighs nothing
PredictionsData make_predictions(const Sphere& sphere, std::uint32_t q, std::uint32_t components) {
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
      for (std::uint32_t e = 0; e < components * components; ++e) {
        const int near = k < 2 && e % (components + 1) == 0 ? half : 0;
        const int weight = near + static_cast<int>((37 * std::size_t{i} + 11 * k) * (e + 1)) % spread - spread / 2;
        predictions.weight.push_back(static_cast<std::int16_t>(inside ? weight : 0));
      }
    }
  }
  return predictions;
}

LevelData make_level(const Sphere& sphere, std::uint32_t q, const SyntheticOptions& options) {
  constexpr layout::StencilRecord none{{layout::none, layout::none},
                                       {layout::none, layout::none, layout::none, layout::none}};
  LevelData level;
  const layout::Wavelet wavelet = options.wavelet;
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
  if (q > 0 && wavelet == layout::Wavelet::equilibrated)
    level.predictions = make_predictions(sphere, q, options.components);
  return level;
}

}  // namespace

Matrix3d synthetic_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  Matrix3d core;
  core << 1, 0.2, 0.1, 0.2, 0.9, 0.15, 0.1, 0.15, 0.8;
  return softness * std::exp(-(x - y).norm() / range) * frame_at(x) * core * frame_at(y).transpose();
}

double synthetic_scalar_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  return softness * std::exp(-(x - y).norm() / range);
}

namespace {

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

// N a unit of each load on each domain node, 3 domain x loads
MatrixXd load_forces(const Sphere& sphere, const SyntheticOptions& options) {
  const Index accelerations = options.gravity ? layout::accelerations : 0;
  MatrixXd forces = MatrixXd::Zero(0, accelerations + options.pressures);
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    if (!sphere.has(i, layout::node_domain)) continue;
    const Sphere::Point& x = sphere.positions[i];
    forces.conservativeResize(forces.rows() + 3, Eigen::NoChange);
    forces.bottomRows<3>().setZero();
    for (Index k = 0; k < accelerations; ++k) forces(forces.rows() - 3 + k, k) = area_density * sphere.areas[i];
    for (std::uint32_t k = 0; k < options.pressures; ++k) {
      if (x[k % 3] < 0) continue;
      forces.col(accelerations + k).tail<3>() = -sphere.areas[i] / Sphere::radius * Eigen::Vector3d(x[0], x[1], x[2]);
    }
  }
  return forces;
}

std::vector<layout::LoadRecord> load_records(const MatrixXd& forces, const SyntheticOptions& options) {
  std::vector<layout::LoadRecord> records;
  for (Index load = 0; load < forces.cols(); ++load) {
    const bool pressure = !options.gravity || load >= layout::accelerations;
    layout::LoadRecord record{};
    record.kind =
        pressure ? static_cast<std::uint32_t>(layout::LoadKind::pressure) : static_cast<std::uint32_t>(load + 1);
    const MatrixXd own = forces.col(load).reshaped(3, forces.rows() / 3);
    for (Index k = 0; k < 3; ++k) record.resultant[k] = static_cast<float>(own.row(k).sum());
    const std::string name = "pressure " + std::to_string(options.gravity ? load - layout::accelerations : load);
    if (pressure) std::copy(name.begin(), name.end(), record.name);
    records.push_back(record);
  }
  return records;
}

void set_problem(layout::Info& info, std::uint32_t components) {
  const bool scalar = components == 1;
  info.problem = static_cast<std::uint32_t>(scalar ? layout::Problem::scalar : layout::Problem::elastostatic);
  info.components = components;
  info.young = scalar ? 0 : 1e5;
  info.poisson = scalar ? 0 : 0.4;
}

template <unsigned N>
void compress(const Sphere& sphere, const SyntheticOptions& options, ModelData& model) {
  const MatrixXd compliance = exact_compliance<N>(sphere);
  Compression<N> compression(model, options);
  compression.run(compliance);
  if (!options.gravity && options.pressures == 0) return;
  const MatrixXd forces = load_forces(sphere, options);
  model.loads = load_records(forces, options);
  compression.add_loads(compliance, forces);
}

}  // namespace

ModelData synthetic_model(const SyntheticOptions& options) {
  Sphere sphere = make_sphere(options.levels, options.touchable_above);
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    if (sphere.positions[i][2] < options.read_above * Sphere::radius) {
      sphere.flags[i] &= ~static_cast<std::uint32_t>(layout::node_read);
    }
  }
  ModelData model;
  set_problem(model.info, options.components);
  model.info.wavelet = static_cast<std::uint32_t>(options.wavelet);
  model.info.threshold = options.epsilon;
  model.info.rate = 1000;
  model.info.max_contacts = 16;
  model.info.step_work = 1'000'000;
  model.info.coarsest_constraint_level = options.coarsest_constraint_level;
  model.provenance = R"({"generator": "synthetic sphere"})";
  for (const auto& t : sphere.base) model.base_triangles.insert(model.base_triangles.end(), t.begin(), t.end());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    model.levels.push_back(make_level(sphere, q, options));
    if (q >= options.coarsest_constraint_level) model.levels.back().representatives = representatives(sphere, q);
  }
  model.vertices = vertex_map(sphere, options.vertices);
  options.components == 1 ? compress<1>(sphere, options, model) : compress<3>(sphere, options, model);
  return model;
}

}  // namespace greenloop
