#pragma once

#include "formats/writer.hpp"

namespace greenloop {

/// The smallest model there is, the worked example of docs/format.md: one triangle of side 1 m, two nodes fixed, the
/// third free; a force of 1 N on it moves it by 1/16 m along the force. For tests only.
[[nodiscard]] ModelData smallest_model();

}  // namespace greenloop
