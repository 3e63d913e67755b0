#pragma once

#include <filesystem>

#include "formats/aligned_bytes.hpp"
#include "formats/verify.hpp"

namespace greenloop {

/// The whole file in 64-byte-aligned memory. Throws std::runtime_error naming the file and the reason. Offline only.
[[nodiscard]] AlignedBytes load_file(const std::filesystem::path& path);

/// A model file in memory together with its verified view, which points into `bytes`. Move only.
struct ModelFile {
  AlignedBytes bytes;
  ModelView view;
};

/// load_file and verify. Throws std::runtime_error naming the file and what is wrong with it. Offline only.
[[nodiscard]] ModelFile open_model_file(const std::filesystem::path& path);

}  // namespace greenloop
