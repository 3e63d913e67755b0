#include "offline/compress/lifted_linear.hpp"

#include <stdexcept>
#include <string>

#include "formats/layout.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

template <typename T>
void undo_step(const LiftedLinear::Step* begin, const LiftedLinear::Step* end, T* x) {
  for (const auto* step = begin; step != end; ++step) {
    const T* detail = x + width * step->row;
    for (int side = 0; side < 2; ++side) {
      T* parent = x + width * step->parent[side];
      const T lift = static_cast<T>(step->lift[side]);
      for (std::size_t k = 0; k < width; ++k) parent[k] -= lift * detail[k];
    }
  }
  for (const auto* step = begin; step != end; ++step) {
    T* odd = x + width * step->row;
    const T* a = x + width * step->parent[0];
    const T* b = x + width * step->parent[1];
    for (std::size_t k = 0; k < width; ++k) odd[k] += T{0.5} * (a[k] + b[k]);
  }
}

}  // namespace

LiftedLinear::LiftedLinear(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                           const std::vector<double>& area) {
  const std::size_t count = mesh.positions.size();
  if (flags.size() != count || area.size() != count || mesh.vertex_end.empty()) {
    throw std::invalid_argument("wavelet: " + std::to_string(flags.size()) + " flags and " +
                                std::to_string(area.size()) + " areas for " + std::to_string(count) +
                                " nodes; give one per node");
  }
  std::vector<std::uint32_t> row(count, layout::none);
  row_begin_.push_back(0);
  std::size_t node = 0;
  for (const std::size_t end : mesh.vertex_end) {
    for (; node < end; ++node) {
      if ((flags[node] & layout::node_domain) == 0) continue;
      if (!(area[node] > 0)) {
        throw std::invalid_argument("wavelet: area of node " + std::to_string(node) + " is " +
                                    std::to_string(area[node]) + " m^2; it must be positive");
      }
      row[node] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back(node);
    }
    row_begin_.push_back(nodes_.size());
  }

  const auto zero_row = static_cast<std::uint32_t>(nodes_.size());
  for (std::size_t r = row_begin_[1]; r < nodes_.size(); ++r) {
    Step step{.row = static_cast<std::uint32_t>(r)};
    for (int side = 0; side < 2; ++side) {
      const auto parent = static_cast<std::size_t>(mesh.parents[nodes_[r]][static_cast<std::size_t>(side)]);
      if (row[parent] == layout::none && (flags[parent] & layout::node_fixed) == 0) {
        throw std::invalid_argument("wavelet: node " + std::to_string(parent) + " is a free parent of domain node " +
                                    std::to_string(nodes_[r]) + " but not in the domain; close the domain first");
      }
      step.parent[side] = row[parent] == layout::none ? zero_row : row[parent];
    }
    steps_.push_back(step);
  }

  integrals_.resize(levels());
  std::vector<double> integral;
  for (const std::size_t n : nodes_) integral.push_back(area[n]);
  for (std::size_t level = levels(); level-- > 0;) {
    integral.resize(row_begin_[level + 1]);
    integrals_[level] = integral;
    if (level == 0) break;
    const std::size_t begin = row_begin_[level], end = row_begin_[level + 1];
    for (std::size_t r = begin; r < end; ++r) {
      for (const std::uint32_t parent : steps_[r - row_begin_[1]].parent) {
        if (parent != zero_row) integral[parent] += 0.5 * integral[r];
      }
    }
    for (std::size_t r = begin; r < end; ++r) {
      auto& step = steps_[r - row_begin_[1]];
      for (int side = 0; side < 2; ++side) {
        const std::uint32_t parent = step.parent[side];
        if (parent != zero_row) step.lift[side] = static_cast<float>(integral[r] / (2.0 * integral[parent]));
      }
    }
  }
}

void LiftedLinear::forward(double* x) const {
  for (std::size_t level = levels(); level-- > 1;) {
    const Step* begin = steps_.data() + (row_begin_[level] - row_begin_[1]);
    const Step* end = steps_.data() + (row_begin_[level + 1] - row_begin_[1]);
    for (const auto* step = begin; step != end; ++step) {
      double* odd = x + width * step->row;
      const double* a = x + width * step->parent[0];
      const double* b = x + width * step->parent[1];
      for (std::size_t k = 0; k < width; ++k) odd[k] -= 0.5 * (a[k] + b[k]);
    }
    for (const auto* step = begin; step != end; ++step) {
      const double* detail = x + width * step->row;
      for (int side = 0; side < 2; ++side) {
        double* parent = x + width * step->parent[side];
        const double lift = static_cast<double>(step->lift[side]);
        for (std::size_t k = 0; k < width; ++k) parent[k] += lift * detail[k];
      }
    }
  }
}

void LiftedLinear::inverse(double* x) const {
  for (std::size_t level = 1; level < levels(); ++level) {
    undo_step(steps_.data() + (row_begin_[level] - row_begin_[1]),
              steps_.data() + (row_begin_[level + 1] - row_begin_[1]), x);
  }
}

void LiftedLinear::inverse(float* x) const {
  for (std::size_t level = 1; level < levels(); ++level) {
    undo_step(steps_.data() + (row_begin_[level] - row_begin_[1]),
              steps_.data() + (row_begin_[level + 1] - row_begin_[1]), x);
  }
}

}  // namespace greenloop::offline
