#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace greenloop {

/// A model file as C source, for firmware that links it into flash.
struct CArray {
  std::string header;  ///< declares `const unsigned char NAME[]` and `const size_t NAME_size`; C99 and C++
  std::string source;  ///< defines both, 64-byte aligned; C11
};

/// `name` must be a C identifier; `header_file` is what the source includes. Deterministic text, about four characters
/// per byte. Throws std::invalid_argument if `name` is no identifier. Offline only.
[[nodiscard]] CArray c_array(std::span<const std::byte> file, std::string_view name, std::string_view header_file);

/// BASE.h and BASE.c, for BASE = `path` without its extension.
struct CArrayFiles {
  std::filesystem::path header, source;
};
[[nodiscard]] CArrayFiles c_array_files(const std::filesystem::path& path);

/// Throws std::runtime_error if the one of both files that `path` does not name is there and was not written by
/// write_c_array.
void require_replaceable(const std::filesystem::path& path);

/// Writes both files; the array is called after the file's stem (see identifier_from). Throws std::runtime_error.
void write_c_array(const std::filesystem::path& path, std::span<const std::byte> file);

}  // namespace greenloop
