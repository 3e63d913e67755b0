#include "offline/compress/wavelet/surface_wavelet.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

#include "formats/stored_blocks.hpp"
#include "offline/compress/wavelet/butterfly_stencil.hpp"

namespace greenloop::offline {
namespace {

void add(double weight, const double* from, std::size_t width, double* to) {
  for (std::size_t k = 0; k < width; ++k) to[k] += weight * from[k];
}

bool any(const double* x, std::size_t width) {
  return std::any_of(x, x + width, [](double number) { return number != 0; });
}

// every vector of `to` += sign * weight * that of `from`
void add(double sign, const Eigen::Matrix3d& weight, const double* from, std::size_t width, double* to) {
  for (std::size_t k = 0; k < width; k += 3) {
    Eigen::Map<Eigen::Vector3d>(to + k) += sign * weight * Eigen::Map<const Eigen::Vector3d>(from + k);
  }
}

// parent += sign * lift * odd
void lift(std::span<const SurfaceWavelet::Odd> odds, double sign, std::size_t width, double* x) {
  for (const auto& odd : odds) {
    for (int side = 0; side < 2; ++side) {
      if (odd.lift[side] == 0) continue;
      add(sign * static_cast<double>(odd.lift[side]), x + width * odd.row, width, x + width * odd.parent[side]);
    }
  }
}

// odd += sign * prediction
void predict(const SurfaceWavelet& wavelet, std::size_t level, double sign, std::size_t width, double* x) {
  for (const auto& odd : wavelet.odds(level)) {
    double* const own = x + width * odd.row;
    if (wavelet.has_blocks()) {
      for (const auto& [row, weight] : wavelet.block_prediction(odd)) add(sign, weight, x + width * row, width, own);
    } else {
      for (const auto& [row, weight] : odd.prediction()) add(sign * weight, x + width * row, width, own);
    }
  }
}

template <unsigned N>
PredictionsData load_predictions(const LevelView& level) {
  PredictionsData data{.terms = level.predictions.terms, .index = {}, .weight = {}};
  for (std::size_t k = 0; k < std::size_t{data.terms} * level.counts->domain_count; ++k) {
    data.index.push_back(stored_source(level.predictions, k));
    for (std::uint32_t e = 0; e < N * N; ++e) data.weight.push_back(stored_weight<N>(level.predictions, k, e));
  }
  return data;
}

template <class Nodes, class Test>
bool all_nodes(const Nodes& nodes, Test test) {
  return std::all_of(std::begin(nodes), std::end(nodes), test);
}

}  // namespace

SurfaceWavelet::SurfaceWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                               const std::vector<double>& area, layout::Wavelet kind)
    : kind_(kind), predictions_(mesh.vertex_end.size()) {
  if (kind == layout::Wavelet::equilibrated) {
    throw std::invalid_argument("wavelet: equilibrated prediction is given by its weights");
  }
  describe(mesh, flags, area);
  integrate(area);
}

void SurfaceWavelet::describe(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                              const std::vector<double>& area) {
  const std::size_t count = mesh.positions.size();
  if (flags.size() != count || area.size() != count || mesh.vertex_end.empty()) {
    throw std::invalid_argument("wavelet: " + std::to_string(flags.size()) + " flags and " +
                                std::to_string(area.size()) + " areas for " + std::to_string(count) +
                                " nodes; give one per node");
  }
  number_rows(mesh, flags, area);
  if (layout::is_butterfly(kind_)) find_stencils(mesh, flags);
  find_parents(mesh, flags);
}

SurfaceWavelet::SurfaceWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                               const std::vector<double>& area, std::vector<PredictionsData> predictions,
                               std::uint32_t components)
    : kind_(layout::Wavelet::equilibrated), predictions_(std::move(predictions)) {
  describe(mesh, flags, area);
  decode_predictions(components);
  integrate(area);
}

SurfaceWavelet::SurfaceWavelet(const ModelView& view) : kind_(static_cast<layout::Wavelet>(view.info->wavelet)) {
  row_of_node_.assign(view.node_count, no_row);
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& at = view.level[level];
    predictions_.push_back(view.info->components == 1 ? load_predictions<1>(at) : load_predictions<3>(at));
    if (at.stencils != nullptr) stencils_.insert(stencils_.end(), at.stencils, at.stencils + at.counts->domain_count);
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      row_of_node_[at.node_begin + i] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back(at.node_begin + i);
    }
    row_end_.push_back(nodes_.size());
    for (std::uint32_t i = 0; level > 0 && i < at.counts->domain_count; ++i) {
      const auto& [parent, lift] = at.refinement[i];
      odds_.push_back(make_odd(row_end_[level - 1] + i, parent[0], parent[1]));
      std::copy_n(lift, 2, odds_.back().lift);
    }
  }
  if (kind_ == layout::Wavelet::equilibrated) decode_predictions(view.info->components);
}

void SurfaceWavelet::decode_predictions(std::uint32_t components) {
  if (predictions_.size() != row_end_.size()) {
    throw std::invalid_argument("wavelet: predictions of " + std::to_string(predictions_.size()) + " levels for " +
                                std::to_string(row_end_.size()));
  }
  if (components != 1) block_begin_ = {0};
  for (std::size_t level = 1; level <= finest(); ++level) {
    require_fit(level, std::size_t{components} * components);
    has_blocks() ? decode_blocks(level) : decode_numbers(level);
  }
}

// weights: numbers of one
void SurfaceWavelet::require_fit(std::size_t level, std::size_t weights) const {
  const PredictionsData& data = predictions_[level];
  const std::size_t nodes = row_end_[level] - row_end_[level - 1], terms = data.terms * nodes;
  if (data.terms > layout::most_prediction_terms || data.index.size() != terms ||
      data.weight.size() != weights * terms) {
    throw std::invalid_argument("wavelet: predictions of level " + std::to_string(level) + " are not of its " +
                                std::to_string(nodes) + " domain nodes");
  }
  for (const std::uint32_t row : data.index) {
    if (row >= row_end_[level - 1]) {
      throw std::invalid_argument("wavelet: row " + std::to_string(row) + " predicts one of level " +
                                  std::to_string(level) + " but is not of a coarser one");
    }
  }
}

void SurfaceWavelet::decode_numbers(std::size_t level) {
  const PredictionsData& data = predictions_[level];
  for (std::size_t r = row_end_[level - 1], k = 0; r < row_end_[level]; ++r) {
    auto& odd = odds_[r - row_end_[0]];
    odd.terms = data.terms;
    for (std::uint32_t t = 0; t < data.terms; ++t, ++k) {
      odd.term[t] = {.row = data.index[k], .weight = double{layout::prediction_unit} * data.weight[k]};
    }
  }
}

void SurfaceWavelet::decode_blocks(std::size_t level) {
  const PredictionsData& data = predictions_[level];
  for (std::size_t k = 0; k < data.index.size(); ++k) {
    BlockTerm term{.row = data.index[k], .weight = {}};
    for (Eigen::Index e = 0; e < 9; ++e) {
      const std::int16_t weight = data.weight[9 * k + static_cast<std::size_t>(e)];
      term.weight(e % 3, e / 3) = double{layout::prediction_unit} * weight;
    }
    block_terms_.push_back(term);
  }
  for (std::size_t r = row_end_[level - 1]; r < row_end_[level]; ++r) {
    block_begin_.push_back(block_begin_.back() + data.terms);
  }
}

std::span<const SurfaceWavelet::BlockTerm> SurfaceWavelet::block_prediction(const Odd& odd) const {
  if (block_begin_.empty()) return {};
  const std::size_t begin = block_begin_[odd.row - row_end_[0]], end = block_begin_[odd.row - row_end_[0] + 1];
  return std::span(block_terms_).subspan(begin, end - begin);
}

void SurfaceWavelet::number_rows(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                 const std::vector<double>& area) {
  row_of_node_.assign(flags.size(), no_row);
  std::size_t node = 0;
  for (const std::size_t end : mesh.vertex_end) {
    for (; node < end; ++node) {
      if ((flags[node] & layout::node_domain) == 0) continue;
      if (!(area[node] > 0)) {
        throw std::invalid_argument("wavelet: area of node " + std::to_string(node) + " is " +
                                    std::to_string(area[node]) + " m^2; it must be positive");
      }
      row_of_node_[node] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back(node);
    }
    row_end_.push_back(nodes_.size());
  }
}

void SurfaceWavelet::find_stencils(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags) {
  const auto known = [&](std::uint32_t node) {
    return node != layout::none && (row_of_node_[node] != no_row || (flags[node] & layout::node_fixed) != 0);
  };
  for (std::size_t level = 1; level <= finest(); ++level) {
    const auto of_nodes = butterfly_stencils(mesh, level);
    for (std::size_t r = row_end_[level - 1]; r < row_end_[level]; ++r) {
      const layout::StencilRecord& stencil = of_nodes[nodes_[r] - mesh.vertex_end[level - 1]];
      const bool usable = all_nodes(stencil.wing, known) && all_nodes(stencil.outer, known);
      stencils_.push_back(usable ? stencil : no_stencil);
    }
  }
}

void SurfaceWavelet::find_parents(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags) {
  for (std::size_t r = row_end_[0]; r < nodes_.size(); ++r) {
    const auto& parents = mesh.parents[nodes_[r]];
    for (const int node : parents) {
      const auto parent = static_cast<std::size_t>(node);
      if (row_of_node_[parent] == no_row && (flags[parent] & layout::node_fixed) == 0) {
        throw std::invalid_argument("wavelet: node " + std::to_string(parent) + " is a free parent of domain node " +
                                    std::to_string(nodes_[r]) + " but not in the domain; close the domain first");
      }
    }
    odds_.push_back(make_odd(r, static_cast<std::size_t>(parents[0]), static_cast<std::size_t>(parents[1])));
  }
}

// not lifted yet
SurfaceWavelet::Odd SurfaceWavelet::make_odd(std::size_t row, std::size_t a, std::size_t b) const {
  Odd odd{.row = static_cast<std::uint32_t>(row), .parent = {row_of_node_[a], row_of_node_[b]}};
  const auto add_term = [&](std::uint32_t from, double weight) {
    if (from != no_row) odd.term[odd.terms++] = {.row = from, .weight = weight};
  };
  for (const std::uint32_t parent : odd.parent) add_term(parent, 0.5);
  if (stencils_.empty() || !has_stencil(stencils_[row - row_end_[0]])) return odd;
  const layout::StencilRecord& stencil = stencils_[row - row_end_[0]];
  for (const std::uint32_t node : stencil.wing) add_term(row_of_node_[node], double{layout::wing_weight});
  for (const std::uint32_t node : stencil.outer) add_term(row_of_node_[node], double{layout::outer_weight});
  return odd;
}

void SurfaceWavelet::integrate(const std::vector<double>& area) {
  integrals_.resize(row_end_.size());
  std::vector<double> integral;
  integral.reserve(nodes_.size());
  for (const std::size_t node : nodes_) integral.push_back(area[node]);
  integrals_.back() = integral;
  for (std::size_t level = finest(); level > 0; --level) {
    for (const auto& odd : odds(level)) {
      for (const auto& [row, weight] : odd.prediction()) integral[row] += weight * integral[odd.row];
    }
    if (layout::is_lifted(kind_)) lift_level(level, integral);
    integral.resize(row_end_[level - 1]);
    integrals_[level - 1] = integral;
  }
}

// integral: of the scaling functions of level - 1 on the rows of K(level - 1), of `level` on those of M(level)
void SurfaceWavelet::lift_level(std::size_t level, const std::vector<double>& integral) {
  for (std::size_t r = row_end_[level - 1]; r < row_end_[level]; ++r) {
    auto& odd = odds_[r - row_end_[0]];
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t parent = odd.parent[side];
      if (parent == no_row || !(integral[r] > 0) || !(2.0 * integral[parent] > integral[r])) continue;
      odd.lift[side] = static_cast<float>(integral[r] / (2.0 * integral[parent]));
    }
  }
}

std::span<const layout::StencilRecord> SurfaceWavelet::stencils(std::size_t level) const {
  if (stencils_.empty()) return {};
  return std::span(stencils_).subspan(row_end_[level - 1] - row_end_[0], row_end_[level] - row_end_[level - 1]);
}

std::span<const SurfaceWavelet::Odd> SurfaceWavelet::odds(std::size_t level) const {
  return std::span(odds_).subspan(row_end_[level - 1] - row_end_[0], row_end_[level] - row_end_[level - 1]);
}

void SurfaceWavelet::split(std::size_t level, std::size_t width, double* x) const {
  predict(*this, level, -1, width, x);
  lift(odds(level), 1, width, x);
}

void SurfaceWavelet::merge(std::size_t level, std::size_t width, double* x) const {
  lift(odds(level), -1, width, x);
  predict(*this, level, 1, width, x);
}

void SurfaceWavelet::split_forces(std::size_t level, std::size_t width, double* f) const {
  for (const auto& odd : odds(level)) {
    const double* const own = f + width * odd.row;
    if (!any(own, width)) continue;
    if (has_blocks()) {
      for (const auto& [row, weight] : block_prediction(odd)) add(1, weight.transpose(), own, width, f + width * row);
    } else {
      for (const auto& [row, weight] : odd.prediction()) add(weight, own, width, f + width * row);
    }
  }
  for (const auto& odd : odds(level)) {
    for (int side = 0; side < 2; ++side) {
      if (odd.lift[side] == 0) continue;
      const double* const parent = f + width * odd.parent[side];
      if (any(parent, width)) add(-static_cast<double>(odd.lift[side]), parent, width, f + width * odd.row);
    }
  }
}

}  // namespace greenloop::offline
