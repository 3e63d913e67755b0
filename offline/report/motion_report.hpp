#pragma once

#include "offline/report/report.hpp"

namespace greenloop::offline {

/// The report of an impulse response model: errors and costs, what each impulse does from rest as pictures, error
/// against modes, size against the frames it stands for, orbits and impulses, and a run if there is a trace
/// (greenloop-loop --script impulses --trace). Takes model, trace and provenance of the inputs; throws
/// std::runtime_error for others, or naming file, line and column if the trace is wrong. Work: linear in the inputs,
/// plus rendering. The same inputs give the same bytes.
[[nodiscard]] Report make_motion_report(const ModelFile& model, const ReportInputs& inputs);

}  // namespace greenloop::offline
