#include "formats/write/model_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "formats/write/describe.hpp"

namespace greenloop {

AlignedBytes load_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error(path.string() + ": cannot be read: " + error.message());
  AlignedBytes bytes(static_cast<std::size_t>(size));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be opened: " + std::strerror(errno));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(file.gcount()) != size) {
    throw std::runtime_error(path.string() + ": ends after " + std::to_string(file.gcount()) + " of " +
                             std::to_string(size) + " bytes");
  }
  return bytes;
}

ModelFile verified_model(AlignedBytes bytes, const std::string& name) {
  ModelFile model{std::move(bytes), {}};
  const VerifyResult result = verify(model.bytes.span(), model.view);
  if (!result.ok()) throw std::runtime_error(name + ": " + describe(result));
  return model;
}

void require_problem(const FileView& model, layout::Problem problem, const std::filesystem::path& file) {
  if (model.problem == problem) return;
  throw std::runtime_error(fmt::format("{}: this is a {} model; only {} ones are taken here", file.string(),
                                       problem_name(model.problem), problem_name(problem)));
}

ModelFile open_model_file(const std::filesystem::path& path) { return verified_model(load_file(path), path.string()); }

}  // namespace greenloop
