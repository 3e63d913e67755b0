#pragma once

#include "formats/write/writer.hpp"

namespace greenloop {

/// The smallest model there is, the worked example of docs/format.md: one triangle of side 1 m, two free nodes, of
/// which one is touchable, and a fixed one; a force of 1 N on a free node moves it by 1/16 m along the force. For tests
/// only.
[[nodiscard]] ModelData smallest_model();

/// The same of a scalar problem: a unit load on a node of the domain causes 1/16 there. For tests only.
[[nodiscard]] ModelData smallest_scalar_model();

/// A valid model of `levels` levels of `nodes` nodes each (at least 6), all of which may be touched, without couplings:
/// of the most nodes that a file of its length can have, each predicted from arbitrary nodes before it. For tests only.
[[nodiscard]] ModelData crowded_model(std::uint32_t nodes, std::uint32_t levels,
                                      layout::Wavelet wavelet = layout::Wavelet::lifted_butterfly);

}  // namespace greenloop
