#pragma once

#include "offline/report/report.hpp"

namespace greenloop::offline {

/// The report of a multigrid model: its grids, memory and work, pictures of its materials and of the body under its
/// weight, the residual of a step against cycles, and a run if there are a trace and a snapshot (greenloop-loop
/// --script drag). Takes model, trace, snapshot and provenance of the inputs; throws std::runtime_error for others, or
/// naming file, line and column if one of these is wrong. Work: linear in the inputs, plus rendering and at most some
/// seconds of steps. The same inputs give the same bytes.
[[nodiscard]] Report make_elastic_report(const ModelFile& model, const ReportInputs& inputs);

}  // namespace greenloop::offline
