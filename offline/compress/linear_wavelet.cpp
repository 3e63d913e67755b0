#include "offline/compress/linear_wavelet.hpp"

#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

void add(double weight, const double* from, std::size_t width, double* to) {
  for (std::size_t k = 0; k < width; ++k) to[k] += weight * from[k];
}

// parent += sign * lift * odd
void lift(std::span<const LinearWavelet::Odd> odds, double sign, std::size_t width, double* x) {
  for (const auto& odd : odds) {
    for (int side = 0; side < 2; ++side) {
      if (odd.lift[side] == 0) continue;
      add(sign * static_cast<double>(odd.lift[side]), x + width * odd.row, width, x + width * odd.parent[side]);
    }
  }
}

// odd += weight * parent
void predict(std::span<const LinearWavelet::Odd> odds, double weight, std::size_t width, double* x) {
  for (const auto& odd : odds) {
    for (const std::uint32_t parent : odd.parent) {
      if (parent != LinearWavelet::no_row) add(weight, x + width * parent, width, x + width * odd.row);
    }
  }
}

}  // namespace

LinearWavelet::LinearWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                             const std::vector<double>& area, bool lifted)
    : lifted_(lifted) {
  const std::size_t count = mesh.positions.size();
  if (flags.size() != count || area.size() != count || mesh.vertex_end.empty()) {
    throw std::invalid_argument("wavelet: " + std::to_string(flags.size()) + " flags and " +
                                std::to_string(area.size()) + " areas for " + std::to_string(count) +
                                " nodes; give one per node");
  }
  number_rows(mesh, flags, area);
  find_parents(mesh, flags);
  integrate(area);
}

LinearWavelet::LinearWavelet(const ModelView& view)
    : lifted_(view.info->wavelet == static_cast<std::uint32_t>(layout::Wavelet::lifted_linear)) {
  row_of_node_.assign(view.node_count, no_row);
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& at = view.level[level];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      row_of_node_[at.node_begin + i] = static_cast<std::uint32_t>(nodes_.size());
      if (level > 0) {
        const auto& [parent, lift] = at.refinement[i];
        odds_.push_back({.row = static_cast<std::uint32_t>(nodes_.size()),
                         .parent = {row_of_node_[parent[0]], row_of_node_[parent[1]]},
                         .lift = {lift[0], lift[1]}});
      }
      nodes_.push_back(at.node_begin + i);
    }
    row_end_.push_back(nodes_.size());
  }
}

void LinearWavelet::number_rows(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
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

void LinearWavelet::find_parents(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags) {
  for (std::size_t r = row_end_[0]; r < nodes_.size(); ++r) {
    Odd odd{.row = static_cast<std::uint32_t>(r)};
    for (int side = 0; side < 2; ++side) {
      const auto parent = static_cast<std::size_t>(mesh.parents[nodes_[r]][static_cast<std::size_t>(side)]);
      odd.parent[side] = row_of_node_[parent];
      if (odd.parent[side] == no_row && (flags[parent] & layout::node_fixed) == 0) {
        throw std::invalid_argument("wavelet: node " + std::to_string(parent) + " is a free parent of domain node " +
                                    std::to_string(nodes_[r]) + " but not in the domain; close the domain first");
      }
    }
    odds_.push_back(odd);
  }
}

void LinearWavelet::integrate(const std::vector<double>& area) {
  integrals_.resize(row_end_.size());
  std::vector<double> integral;
  integral.reserve(nodes_.size());
  for (const std::size_t node : nodes_) integral.push_back(area[node]);
  integrals_.back() = integral;
  for (std::size_t level = finest(); level > 0; --level) {
    for (const auto& odd : odds(level)) {
      for (const std::uint32_t parent : odd.parent) {
        if (parent != no_row) integral[parent] += 0.5 * integral[odd.row];
      }
    }
    for (std::size_t r = row_end_[level - 1]; r < row_end_[level] && lifted_; ++r) {
      auto& odd = odds_[r - row_end_[0]];
      for (int side = 0; side < 2; ++side) {
        const std::uint32_t parent = odd.parent[side];
        if (parent != no_row) odd.lift[side] = static_cast<float>(integral[r] / (2.0 * integral[parent]));
      }
    }
    integral.resize(row_end_[level - 1]);
    integrals_[level - 1] = integral;
  }
}

std::span<const LinearWavelet::Odd> LinearWavelet::odds(std::size_t level) const {
  return std::span(odds_).subspan(row_end_[level - 1] - row_end_[0], row_end_[level] - row_end_[level - 1]);
}

void LinearWavelet::split(std::size_t level, std::size_t width, double* x) const {
  predict(odds(level), -0.5, width, x);
  lift(odds(level), 1, width, x);
}

void LinearWavelet::merge(std::size_t level, std::size_t width, double* x) const {
  lift(odds(level), -1, width, x);
  predict(odds(level), 0.5, width, x);
}

void LinearWavelet::split_forces(std::size_t level, std::size_t width, double* f) const {
  for (const auto& odd : odds(level)) {
    for (const std::uint32_t parent : odd.parent) {
      if (parent != no_row) add(0.5, f + width * odd.row, width, f + width * parent);
    }
  }
  for (const auto& odd : odds(level)) {
    for (int side = 0; side < 2; ++side) {
      if (odd.lift[side] == 0) continue;
      add(-static_cast<double>(odd.lift[side]), f + width * odd.parent[side], width, f + width * odd.row);
    }
  }
}

}  // namespace greenloop::offline
