#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace greenloop::offline {

/// The same model file with what a loop would make of it at its start, as a loop makes it: see ready_file in
/// formats/write/ready_file.hpp. Throws std::invalid_argument if `model` is no valid model file.
[[nodiscard]] std::vector<std::byte> ready_model(std::span<const std::byte> model);

}  // namespace greenloop::offline
