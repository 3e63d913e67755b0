#pragma once

#include <filesystem>
#include <string>

namespace greenloop {

/// To be called before anything of HDF5: it prints nothing of its own, and leaves what a full disk did not take alone
/// when the program ends, where its last attempts to write crash.
void start_hdf5();

/// Why the last call of HDF5 failed, in its own words, from the innermost function out; to be called before another.
[[nodiscard]] std::string hdf5_fault();

/// Whether another process holds a lock on the file: reads a store, or makes one.
[[nodiscard]] bool is_locked(const std::filesystem::path& path);

/// "PATH: cannot be opened: REASON; REMEDY" for a store that HDF5 could not open.
[[nodiscard]] std::string open_fault(const std::filesystem::path& path, const std::string& reason);

}  // namespace greenloop
