#include "offline/compress/wavelet_choice.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/coarse_mesh.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {
namespace {

constexpr double comparison_share = 0.2;  // of the progress

// A body's exact compliance between the nodes of a coarser mesh: the displacements there by the forces there.
class SampledBody {
 public:
  SampledBody(const CompressionInput& input, const SurfaceWavelet& wavelet, std::size_t level)
      : input_(input), mesh_(coarse_mesh(input.mesh, level)), level_(level) {
    const std::size_t rows = wavelet.row_end(level);
    nodes_.assign(wavelet.nodes().begin(), wavelet.nodes().begin() + static_cast<std::ptrdiff_t>(rows));
    area_.resize(mesh_.positions.size());
    for (std::size_t node = 0; node < area_.size(); ++node) {
      const bool domain = (input.flags[node] & layout::node_domain) != 0;
      flags_.push_back(input.flags[node] | (domain ? layout::node_touchable | layout::node_read : 0U));
    }
    for (std::size_t row = 0; row < rows; ++row) area_[nodes_[row]] = wavelet.integrals(level)[row];
    read_columns(static_cast<Eigen::Index>(3 * rows));
  }

  // refers to this object
  [[nodiscard]] CompressionInput input() const {
    CompressionInput sampled{.mesh = mesh_,
                             .flags = flags_,
                             .area = area_,
                             .column_nodes = nodes_,
                             .columns = [this](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
                               return compliance_.middleCols(static_cast<Eigen::Index>(3 * first),
                                                             static_cast<Eigen::Index>(3 * count));
                             },
                             .accuracy = input_.accuracy,
                             .facts = input_.facts,
                             .provenance = input_.provenance,
                             .step_work = input_.step_work};
    sampled.facts.coarsest_constraint_level = static_cast<std::uint32_t>(level_);
    return sampled;
  }

 private:
  void read_columns(Eigen::Index size) {
    constexpr Eigen::Index at_once = Eigen::Index{64} * 3;
    compliance_.resize(size, size);
    for (Eigen::Index first = 0; first < size; first += at_once) {
      const Eigen::Index count = std::min(at_once, size - first);
      compliance_.middleCols(first, count) =
          input_.columns(static_cast<std::size_t>(first / 3), static_cast<std::size_t>(count / 3)).topRows(size);
    }
  }

  const CompressionInput& input_;
  SemiRegularMesh mesh_;
  std::size_t level_;
  std::vector<std::uint32_t> flags_;
  std::vector<double> area_;
  std::vector<std::size_t> nodes_;
  Eigen::MatrixXd compliance_;
};

struct Comparison {
  std::vector<WaveletTrial> trials;
  layout::Wavelet best = layout::Wavelet::lifted_linear;  // also if no trial meets the accuracy
};

double cost(const CompressionInput& input, const Trial& trial) {
  const bool weigh_work = input.facts.step_work > 0 && trial.step_work > 0;
  return static_cast<double>(trial.bytes) * (weigh_work ? static_cast<double>(trial.step_work) : 1.0);
}

// of 0 bytes if the accuracy cannot be met
Trial tried(const CompressionInput& input) {
  try {
    return chosen_trial(input);
  } catch (const std::runtime_error&) {
    return {};
  }
}

Comparison compare_wavelets(CompressionInput input, const Progress& progress) {
  Comparison comparison;
  double least = std::numeric_limits<double>::infinity();
  for (const layout::Wavelet wavelet : layout::wavelets) {
    input.wavelet = wavelet;
    const WaveletTrial trial{.wavelet = wavelet, .nodes = input.column_nodes.size(), .trial = tried(input)};
    if (trial.trial.bytes > 0 && cost(input, trial.trial) < least) {
      least = cost(input, trial.trial);
      comparison.best = wavelet;
    }
    comparison.trials.push_back(trial);
    const auto done = static_cast<double>(comparison.trials.size());
    if (progress)
      progress(comparison_share * done / static_cast<double>(std::size(layout::wavelets)), "compare wavelets");
  }
  return comparison;
}

// the level to compare on
std::size_t comparison_level(const SurfaceWavelet& wavelet, std::size_t least_rows) {
  std::size_t level = 0;
  while (level < wavelet.finest() && wavelet.row_end(level) < least_rows) ++level;
  return level;
}

}  // namespace

BuiltModel build_with_best_wavelet(CompressionInput input, const Progress& progress, std::size_t least_rows) {
  const SurfaceWavelet wavelet(input.mesh, input.flags, input.area, layout::Wavelet::linear);
  if (wavelet.finest() == 0) {  // nothing to transform
    input.wavelet = layout::Wavelet::lifted_linear;
    return build_model(input, progress);
  }
  const std::size_t level = comparison_level(wavelet, least_rows);
  Comparison comparison = level == wavelet.finest()
                              ? compare_wavelets(input, progress)
                              : compare_wavelets(SampledBody(input, wavelet, level).input(), progress);
  input.wavelet = comparison.best;
  const Progress rest = [&](double fraction, std::string_view stage) {
    if (progress) progress(comparison_share + (1 - comparison_share) * fraction, stage);
  };
  BuiltModel built = build_model(input, rest);
  built.report.wavelets = std::move(comparison.trials);
  if (progress) progress(1.0, "done");
  return built;
}

}  // namespace greenloop::offline
