#pragma once

#include "formats/view.hpp"
#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// Whether the model says how right its answers to contact patterns are.
[[nodiscard]] bool has_patterns(const ModelView& model);

/// The worst errors of each kind of contact over the number of contacts: of the field, of the worst node, of the nodal
/// forces; a row of panels per constraint level that was measured, the finest first. has_patterns(model) holds.
[[nodiscard]] Figure patterns_figure(const ModelView& model);

}  // namespace greenloop::offline
