#pragma once

#include <cstdint>
#include <vector>

#include "formats/view/multigrid.hpp"

namespace greenloop {

/// The vertices that a tool drags: free ones that the surface that is shown hangs on most, with nothing around them but
/// the softest matter; ascending. Start-up; work: linear in the model.
[[nodiscard]] std::vector<std::uint32_t> soft_vertices(const MultigridView& view);

}  // namespace greenloop
