#pragma once

#include <memory>
#include <span>
#include <vector>

#include "offline/multigrid/block_matrix.hpp"
#include "offline/multigrid/galerkin.hpp"
#include "runtime/multigrid/cycle.hpp"

namespace greenloop::offline {

/// The levels of a matrix in single precision, finest first, with Galerkin operators, and a factor of the coarsest.
class Hierarchy {
 public:
  /// One prolongation between each level and the next; the coarsest is factored densely, with some hundred vertices in
  /// mind. Throws std::invalid_argument on sizes that do not fit and on a matrix that is not positive definite.
  /// Work: blocks times parents of each level, the cube of the coarsest.
  Hierarchy(const BlockMatrix& matrix, const std::vector<Prolongation>& prolongations);

  Hierarchy(Hierarchy&&) = default;
  Hierarchy& operator=(Hierarchy&&) = default;

  /// z = about the solution of matrix z = r: one V(1,1) cycle, symmetric and positive definite.
  void cycle(std::span<const Double4> r, std::span<Double4> z);

  /// All but the coarsest, and its factor.
  [[nodiscard]] std::span<const MultigridLevel> levels() const { return views_; }
  [[nodiscard]] CoarsestFactor coarsest() const;

  struct LevelSize {
    std::size_t vertices, blocks, bytes;
  };
  /// Of each level, and of the coarsest.
  [[nodiscard]] std::vector<LevelSize> sizes() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Level {
    std::vector<std::uint32_t> start, upper, column, parent_start, parent;
    std::vector<Block<3>> block, inverse;
    std::vector<float> weight;

    [[nodiscard]] MultigridLevel view() const;
  };
  struct Fields {
    std::vector<Float4> b, x;
  };

  void add_level(const BlockMatrix& matrix, const Prolongation& prolongation);
  void factor(const BlockMatrix& matrix);

  std::vector<Level> levels_;
  std::vector<MultigridLevel> views_;
  std::vector<double> coarsest_, scratch_;
  std::vector<Fields> fields_;
  std::vector<MultigridCycle::Fields> field_views_;
};

}  // namespace greenloop::offline
