#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace greenloop::offline {

/// How many levels have a store of at most so many bytes, in words.
using LevelsThatFit = std::function<std::string(double bytes)>;

/// Throws std::runtime_error, naming the file, what it needs, what is free and the remedies, if the disk that `store`
/// stands on, or is to stand on, has no room for the Green's functions of `columns` nodes at `rows` nodes. Leaves a
/// folder that is not there to who creates the file.
void require_store_room(const std::filesystem::path& store, std::size_t rows, std::size_t columns,
                        const LevelsThatFit& levels = {});

}  // namespace greenloop::offline
