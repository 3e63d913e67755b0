#pragma once

#include <filesystem>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// A verified elastostatic model and the bytes it lives in.
struct LoadedModel {
  AlignedBytes bytes;
  Model model;
};

/// Throws std::runtime_error naming the file and the field that is wrong, or its problem if that is another one.
[[nodiscard]] LoadedModel load_model(const std::filesystem::path& file);

}  // namespace greenloop
