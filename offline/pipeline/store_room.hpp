#pragma once

#include <cstddef>
#include <filesystem>

namespace greenloop::offline {

/// Throws std::runtime_error, naming the file, what it needs, what is free and the remedies, if the disk that `store`
/// stands on, or is to stand on, has no room for the Green's functions of `columns` nodes at `rows` nodes. Leaves a
/// folder that is not there to who creates the file.
void require_store_room(const std::filesystem::path& store, std::size_t rows, std::size_t columns);

}  // namespace greenloop::offline
