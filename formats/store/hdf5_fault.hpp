#pragma once

#include <filesystem>
#include <string>

namespace greenloop {

/// Why the last call of HDF5 failed, in its own words, from the innermost function out; to be called before another.
[[nodiscard]] std::string hdf5_fault();

/// Whether another process holds a lock on the file: reads a store, or makes one.
[[nodiscard]] bool is_locked(const std::filesystem::path& path);

/// "PATH: cannot be opened: REASON; REMEDY" for a store that HDF5 could not open.
[[nodiscard]] std::string open_fault(const std::filesystem::path& path, const std::string& reason);

}  // namespace greenloop
