#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"
#include "formats/layout.hpp"
#include "formats/view.hpp"

namespace greenloop::offline {

/// The Linear wavelet transform on the domain nodes of a semi-regular surface, lifted or not (James & Pai 2003, section
/// 4.3; docs/theory.md section 3): midpoint prediction, then, if lifted, one step that gives each wavelet zero mean.
/// Rows are the domain nodes in node order, so that K(l) is the first row_end(l) rows. Nodal arrays hold `width`
/// numbers per row; the steps mix rows only. Offline only.
class LinearWavelet {
 public:
  static constexpr std::uint32_t no_row = layout::none;

  /// One odd node: its row, its parents' rows (no_row: outside the domain, where values are 0), its lifting weights
  /// towards them (0 towards no_row, and everywhere if unlifted).
  struct Odd {
    std::uint32_t row = 0;
    std::uint32_t parent[2] = {};
    float lift[2] = {};
  };

  /// `flags` is one layout::NodeFlag set per node, closed under free parents (mark_domain); `area` the integral of each
  /// node's hat function [m^2], positive. Throws std::invalid_argument if sizes do not fit, an area is not positive or
  /// a free parent of a domain node is outside the domain.
  LinearWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                bool lifted);

  /// The transform of a verified model. Integrals are not stored there: `integrals` may not be called.
  explicit LinearWavelet(const ModelView& view);

  [[nodiscard]] bool lifted() const { return lifted_; }
  [[nodiscard]] std::size_t rows() const { return nodes_.size(); }                        ///< domain nodes
  [[nodiscard]] std::size_t finest() const { return row_end_.size() - 1; }                ///< level L
  [[nodiscard]] std::size_t row_end(std::size_t level) const { return row_end_[level]; }  ///< of K(level)
  [[nodiscard]] const std::vector<std::size_t>& nodes() const { return nodes_; }          ///< node of each row
  [[nodiscard]] std::span<const Odd> odds(std::size_t level) const;  ///< M(level), 1 <= level <= L, by row

  /// Integrals of the scaling functions of `level` on the domain [m^2], for the rows of K(level).
  [[nodiscard]] const std::vector<double>& integrals(std::size_t level) const { return integrals_[level]; }

  /// One forward step T_l in place on the rows of K(level): values to averages on K(level-1) and details on M(level).
  /// Work: 4 * width multiply-adds per odd row, as in the two below.
  void split(std::size_t level, std::size_t width, double* x) const;

  /// T_l^-1: averages and details to values.
  void merge(std::size_t level, std::size_t width, double* x) const;

  /// T_l^-T: the forces conjugate to values, to those conjugate to averages and details.
  void split_forces(std::size_t level, std::size_t width, double* f) const;

 private:
  void number_rows(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                   const std::vector<double>& area);
  void find_parents(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags);
  void integrate(const std::vector<double>& area);

  bool lifted_;
  std::vector<std::size_t> nodes_;
  std::vector<std::uint32_t> row_of_node_;
  std::vector<std::size_t> row_end_;
  std::vector<Odd> odds_;
  std::vector<std::vector<double>> integrals_;
};

}  // namespace greenloop::offline
