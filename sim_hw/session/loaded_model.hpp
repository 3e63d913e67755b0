#pragma once

#include <filesystem>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// A verified model and the bytes it lives in.
struct LoadedModel {
  AlignedBytes bytes;
  Model model;
};

/// Throws std::runtime_error naming the file and the field that is wrong.
[[nodiscard]] LoadedModel load_model(const std::filesystem::path& file);

/// A body and the arena it lives in.
struct LoadedBody {
  AlignedBytes arena;
  Elastostatic body;
};

/// Throws std::runtime_error if the limits are refused.
[[nodiscard]] LoadedBody create_body(const Model& model, const Elastostatic::Limits& limits);

}  // namespace greenloop
