#pragma once

#include <filesystem>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// A verified model and the bytes it lives in.
struct LoadedModel {
  AlignedBytes bytes;
  Model model;
};

/// Throws std::runtime_error naming the file and the field that is wrong, or its problem if that is not the one wanted.
[[nodiscard]] LoadedModel load_model(const std::filesystem::path& file,
                                     layout::Problem problem = layout::Problem::elastostatic);

/// That of a model; elastostatic if it cannot be opened, as load_model then says. Throws std::runtime_error if there is
/// no such file.
[[nodiscard]] layout::Problem problem_of(const std::filesystem::path& file);

}  // namespace greenloop
