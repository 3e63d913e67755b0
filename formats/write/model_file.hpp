#pragma once

#include <filesystem>
#include <string>

#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {

struct ModelData;

/// The whole file in 64-byte-aligned memory. Throws std::runtime_error naming the file and the reason. Offline only.
[[nodiscard]] AlignedBytes load_file(const std::filesystem::path& path);

/// A model file in memory together with its verified view, which points into `bytes`. Move only.
struct ModelFile {
  AlignedBytes bytes;
  ModelView view;
};

/// The file of a model, as encode in writer.hpp makes it, with the view that its verification gave: for who reads on
/// what was just encoded. Throws std::invalid_argument as encode does. Offline only.
[[nodiscard]] ModelFile encoded_file(const ModelData& model);

/// Verifies `bytes`. Throws std::runtime_error with `name`, usually the file's, and what is wrong. Offline only.
[[nodiscard]] ModelFile verified_model(AlignedBytes bytes, const std::string& name);

/// Throws std::runtime_error unless the model of `file` is one of `problem`, which is what the caller takes: it names
/// the file, what it is and what is taken. Offline only.
void require_problem(const FileView& model, layout::Problem problem, const std::filesystem::path& file);

/// load_file and verified_model. Throws std::runtime_error naming the file and what is wrong with it. Offline only.
[[nodiscard]] ModelFile open_model_file(const std::filesystem::path& path);

}  // namespace greenloop
