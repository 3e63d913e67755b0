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

/// Writes BASE.h and BASE.c beside each other for BASE = `path` without its extension; the array is called after the
/// file's stem (see identifier_from). Throws std::runtime_error.
void write_c_array(const std::filesystem::path& path, std::span<const std::byte> file);

}  // namespace greenloop
