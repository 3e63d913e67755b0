#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"

namespace greenloop::offline {

/// The lifted Linear wavelet transform on the domain nodes of a semi-regular surface (James & Pai 2003, section 4.3;
/// docs/theory.md section 3): midpoint prediction, then one lifting step that gives each wavelet zero mean.
/// Nodal arrays hold `components` = 9 numbers per row, one 3x3 block; the rows are the domain nodes in node order,
/// followed by one row of zeros that stands for every other node. Offline only.
class LiftedLinear {
 public:
  static constexpr std::size_t components = 9;

  /// One odd node: its row, its parents' rows, its lifting weights towards them (0 towards parents outside the domain).
  struct Step {
    std::uint32_t row = 0;
    std::uint32_t parent[2] = {};
    float lift[2] = {};
  };

  /// `flags` is one layout::NodeFlag set per node, closed under free parents (mark_domain); `area` the integral of each
  /// node's hat function [m^2], positive. Throws std::invalid_argument if sizes do not fit, an area is not positive or
  /// a free parent of a domain node is outside the domain.
  LiftedLinear(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area);

  [[nodiscard]] std::size_t rows() const { return nodes_.size(); }            ///< domain nodes
  [[nodiscard]] std::size_t levels() const { return row_begin_.size() - 1; }  ///< mesh levels, L + 1
  [[nodiscard]] std::size_t row_begin(std::size_t level) const {
    return row_begin_[level];
  }                                                                               ///< of M(level); levels() ends
  [[nodiscard]] const std::vector<std::size_t>& nodes() const { return nodes_; }  ///< node of each row
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }         ///< coarse to fine

  /// Integrals of the scaling functions of `level` on the domain [m^2], for the rows of K(level).
  [[nodiscard]] const std::vector<double>& integrals(std::size_t level) const { return integrals_[level]; }

  /// Nodal values to wavelet coefficients and back, in place; x has (rows() + 1) * components elements, the last row 0.
  /// The float inverse does the runtime's operations in the runtime's order. Work: 4 * components flops per odd row.
  void forward(double* x) const;
  void inverse(double* x) const;
  void inverse(float* x) const;

 private:
  std::vector<std::size_t> nodes_;
  std::vector<std::size_t> row_begin_;
  std::vector<Step> steps_;
  std::vector<std::vector<double>> integrals_;
};

}  // namespace greenloop::offline
