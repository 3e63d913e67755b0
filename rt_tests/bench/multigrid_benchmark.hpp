#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rt_tests/bench/multigrid_problems.hpp"

namespace greenloop::bench {

/// Set-up and solution by one solver, thread CPU time, to a relative residual of 1e-5.
struct SolverFigures {
  double setup_s = 0, solve_s = 0;
  int iterations = 0;
  double residual = 0;  ///< the true one, computed anew in double precision
  bool reached = false;

  [[nodiscard]] double seconds() const { return setup_s + solve_s; }
};

/// One problem by conjugate gradients on multigrid cycles, on PETSc's algebraic multigrid and on the diagonal.
struct MultigridFigures {
  std::string problem;
  std::size_t tetrahedra = 0, unknowns = 0;
  double contrast = 0, poisson = 0;
  std::vector<std::size_t> levels;  ///< free vertices of each
  std::size_t memory_bytes = 0;     ///< beside the matrix and the right side: hierarchy and vectors
  SolverFigures multigrid;          ///< set-up: transfer between the levels, operators and coarsest factor
  std::optional<SolverFigures> gamg, diagonal;
};

/// Whether others solve the same beside multigrid.
enum class Peers { none, all };

/// Least times of three runs each, of the diagonal one run.
[[nodiscard]] MultigridFigures measure_multigrid(const MultigridProblem& problem, Peers peers);

struct MultigridStudy {
  std::vector<int> cells{12, 24};      ///< along an edge of cubes, at least one
  std::vector<double> contrasts{1e6};  ///< of stiff parts
  int netgen_cells = 12;               ///< of cubes by Netgen; 0 for none
  Peers peers = Peers::all;
};

/// Homogeneous bodies, stiff balls and checkerboards of each number of cells; nu = 0.49 and 0.499 at the last of them;
/// homogeneous bodies and stiff balls by Netgen.
[[nodiscard]] std::vector<MultigridFigures> measure_multigrid(const MultigridStudy& study);

}  // namespace greenloop::bench
