#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/layout.hpp"
#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/view.hpp"
#include "formats/write/writer.hpp"

namespace greenloop::offline {

/// The wavelet transforms on the domain nodes of a semi-regular surface (James & Pai 2003, section 4.3; Schröder &
/// Sweldens 1995; docs/theory.md section 3): Linear or Butterfly prediction, then, if lifted, one step that gives each
/// wavelet zero mean; or Equilibrated prediction (docs/fields.md), whose weights are 3x3 between vectors and numbers
/// between scalars. Rows are the domain nodes in node order, so that K(l) is the first row_end(l) rows. Nodal arrays
/// hold `width` numbers per row; the steps mix rows only, and with 3x3 weights the three numbers of a vector, so that
/// `width` is then a multiple of 3. Offline only.
class SurfaceWavelet {
 public:
  static constexpr std::uint32_t no_row = layout::none;

  /// A row and its weight in a prediction.
  struct Term {
    std::uint32_t row = 0;
    double weight = 0;
  };

  /// A row and its 3x3 weight in a prediction.
  struct BlockTerm {
    std::uint32_t row = 0;
    Eigen::Matrix3d weight;
  };

  /// One odd node: its row, its parents' rows (no_row: outside the domain, where values are 0), its lifting weights
  /// towards them (0 towards no_row, and everywhere if unlifted), and what predicts it with numbers as weights: the
  /// parents first, unless it is Equilibrated. If has_blocks, that is what integrals follow from: half of each parent;
  /// block_prediction() predicts.
  struct Odd {
    std::uint32_t row = 0;
    std::uint32_t parent[2] = {};
    float lift[2] = {};
    std::uint32_t terms = 0;
    std::array<Term, layout::most_prediction_terms> term{};

    [[nodiscard]] std::span<const Term> prediction() const { return std::span(term).first(terms); }
  };

  /// `flags` is one layout::NodeFlag set per node, closed under free parents (mark_domain); `area` the integral of each
  /// node's hat function [m^2], positive. Butterfly prediction needs every node of the stencil to be in the domain or
  /// held; elsewhere it is Linear. kind: not equilibrated. A lifting weight stands only where it lies
  /// between 0 and 1, as those of Linear wavelets do: Butterfly scaling functions may have integrals that are not
  /// positive, or tiny, next to much larger triangles. Throws std::invalid_argument if sizes do not fit, an area is not
  /// positive, a free parent of a domain node is outside the domain, or the kind is equilibrated.
  SurfaceWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                 layout::Wavelet kind);

  /// Of Equilibrated wavelets of fields with 1 or 3 `components` a node; predictions: of each level, none of level 0,
  /// as equilibrated_predictions makes them. Throws as above, and std::invalid_argument if they are not of the mesh's
  /// levels and nodes and of so many components.
  SurfaceWavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                 std::vector<PredictionsData> predictions, std::uint32_t components);

  /// The transform of a verified model. Integrals are not stored there: `integrals` may not be called.
  explicit SurfaceWavelet(const ModelView& view);

  [[nodiscard]] layout::Wavelet kind() const { return kind_; }
  [[nodiscard]] std::size_t rows() const { return nodes_.size(); }                        ///< domain nodes
  [[nodiscard]] std::size_t finest() const { return row_end_.size() - 1; }                ///< level L
  [[nodiscard]] std::size_t row_end(std::size_t level) const { return row_end_[level]; }  ///< of K(level)
  [[nodiscard]] const std::vector<std::size_t>& nodes() const { return nodes_; }          ///< node of each row
  [[nodiscard]] std::span<const Odd> odds(std::size_t level) const;  ///< M(level), 1 <= level <= L, by row

  /// The stencils of M(level) by row, of nodes; empty if prediction is Linear.
  [[nodiscard]] std::span<const layout::StencilRecord> stencils(std::size_t level) const;

  /// The predictions of M(level) as they are stored; none unless Equilibrated.
  [[nodiscard]] const PredictionsData& predictions(std::size_t level) const { return predictions_[level]; }

  /// Whether weights are 3x3.
  [[nodiscard]] bool has_blocks() const { return !block_begin_.empty(); }

  /// What predicts an odd node if has_blocks, else nothing.
  [[nodiscard]] std::span<const BlockTerm> block_prediction(const Odd& odd) const;

  /// Integrals of the scaling functions of `level` on the domain [m^2], for the rows of K(level).
  [[nodiscard]] const std::vector<double>& integrals(std::size_t level) const { return integrals_[level]; }

  /// One forward step T_l in place on the rows of K(level): values to averages on K(level-1) and details on M(level).
  /// Work: 4 (Linear), 10 (Butterfly), 6 or, with 3x3 weights, 18 (Equilibrated) * width multiply-adds per odd row, as
  /// in the two below.
  void split(std::size_t level, std::size_t width, double* x) const;

  /// T_l^-1: averages and details to values.
  void merge(std::size_t level, std::size_t width, double* x) const;

  /// T_l^-T: the forces conjugate to values, to those conjugate to averages and details.
  void split_forces(std::size_t level, std::size_t width, double* f) const;

 private:
  void describe(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, const std::vector<double>& area);
  void number_rows(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                   const std::vector<double>& area);
  void find_stencils(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags);
  void find_parents(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags);
  [[nodiscard]] Odd make_odd(std::size_t row, std::size_t a, std::size_t b) const;
  void integrate(const std::vector<double>& area);
  void lift_level(std::size_t level, const std::vector<double>& integral);
  void decode_predictions(std::uint32_t components);
  void require_fit(std::size_t level, std::size_t weights) const;
  void decode_numbers(std::size_t level);
  void decode_blocks(std::size_t level);

  layout::Wavelet kind_;
  std::vector<std::size_t> nodes_;
  std::vector<std::uint32_t> row_of_node_;
  std::vector<std::size_t> row_end_;
  std::vector<layout::StencilRecord> stencils_;  // of the rows above level 0
  std::vector<PredictionsData> predictions_;     // by level
  std::vector<BlockTerm> block_terms_;           // of the odd nodes, one after the other
  std::vector<std::size_t> block_begin_;         // [odd nodes + 1]; empty unless has_blocks
  std::vector<Odd> odds_;
  std::vector<std::vector<double>> integrals_;
};

}  // namespace greenloop::offline
