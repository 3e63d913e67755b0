#include "rt_tests/bench/multigrid_benchmark.hpp"

#include <doctest/doctest.h>

#include "rt_tests/bench/multigrid_figures.hpp"
#include "rt_tests/bench/petsc_gamg.hpp"

namespace greenloop::bench {
namespace {

TEST_CASE("every solver reaches the tolerance on every small problem") {
  const auto all = measure_multigrid({.cells = {8}, .netgen_cells = 8});
  REQUIRE(all.size() == 7);
  for (const MultigridFigures& figures : all) {
    INFO(figures.problem, " nu ", figures.poisson);
    CHECK(figures.unknowns > 1000);
    CHECK(figures.levels.size() >= 2);
    CHECK(figures.memory_bytes > 0);
    CHECK(figures.multigrid.reached);
    CHECK(figures.multigrid.residual <= 1e-5);
    CHECK(figures.multigrid.iterations <= (figures.poisson < 0.4 ? 40 : 100));
    REQUIRE(figures.diagonal);
    CHECK(figures.diagonal->reached);
    CHECK(figures.diagonal->iterations > 2 * figures.multigrid.iterations);
    CHECK(figures.gamg.has_value() == PetscGamg::available());
    CHECK((!figures.gamg || figures.gamg->reached));
  }
  CHECK(all[1].diagonal->iterations > all[0].diagonal->iterations);
  CHECK(multigrid_figure(all).svg().find("multigrid") != std::string::npos);
}

TEST_CASE("a cube by Netgen fills the cube") {
  const MultigridProblem problem = multigrid_problem(Meshes::netgen, 6, StiffPart::none, 1.0, 0.3);
  double pull = 0.0;
  for (const auto& force : problem.weight()) pull -= force[2];
  // all but what the fixed vertices bear
  CHECK(pull < 1000.0);
  CHECK(pull > 850.0);
  REQUIRE(problem.coarser.size() == 1);
  CHECK(problem.coarser[0].tetrahedra.size() < problem.mesh.tetrahedra.size());
}

}  // namespace
}  // namespace greenloop::bench
