#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace greenloop {

/// The same model, ready for a loop that makes nothing of it at its start: ReadMarks, BaseColumns and MirroredCouplings
/// added, made anew if it has them. model: a model file; read: [domain] 1 for a coefficient that the displacement of a
/// node with layout::node_read depends on, else 0. Throws std::invalid_argument naming what is wrong with either.
/// Offline only; memory: three times the couplings.
[[nodiscard]] std::vector<std::byte> ready_file(std::span<const std::byte> model, std::span<const std::uint8_t> read);

/// The same model without what ready_file adds, of the minor version that it then needs; the very bytes if it is not
/// ready. Throws std::invalid_argument if it is no valid model. Offline only.
[[nodiscard]] std::vector<std::byte> plain_file(std::span<const std::byte> model);

}  // namespace greenloop
