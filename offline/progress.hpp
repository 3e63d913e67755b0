#pragma once

#include <functional>
#include <string_view>

namespace greenloop::offline {

/// Called with the fraction done, 0..1, and what is being done; may be empty.
using Progress = std::function<void(double fraction, std::string_view stage)>;

}  // namespace greenloop::offline
