#pragma once

#include <bit>
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/mesh/binary_scalar.hpp"

namespace greenloop {

/// How a VTK XML file writes its binary arrays.
struct VtkEncoding {
  std::endian order = std::endian::little;
  Scalar header = Scalar::u32;  ///< of the lengths before the data
  bool compressed = false;      ///< by zlib, in blocks
};

/// The bytes that base64 text stands for, up to its first other character but white space; padding inside ends a group,
/// not the text.
[[nodiscard]] std::string decode_base64(std::string_view text);

/// The numbers' bytes behind the lengths at the beginning of `bytes`, decompressed if they are compressed. What the
/// lengths promise is checked against what is there before memory is taken: at most 1032 times as much (zlib's limit)
/// and largest_mesh_file. `place` (file and array) begins the message of the MeshFileError that is thrown.
[[nodiscard]] std::string unpack_array(std::string_view bytes, const VtkEncoding& encoding, const std::string& place);

}  // namespace greenloop
