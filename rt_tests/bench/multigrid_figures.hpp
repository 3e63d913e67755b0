#pragma once

#include <vector>

#include "offline/report/figure.hpp"
#include "rt_tests/bench/multigrid_benchmark.hpp"

namespace greenloop::bench {

/// Georgii & Westermann 2005, figures 2 and 3, beside peers: seconds and iterations against the size of homogeneous
/// cubes, and against the contrast of stiff balls at the largest size with several.
[[nodiscard]] offline::Figure multigrid_figure(const std::vector<MultigridFigures>& all);

}  // namespace greenloop::bench
