#include "formats/output/output_paths.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>

#include "formats/output/output_file.hpp"

namespace greenloop {
namespace {

using Status = struct stat;

std::optional<Status> status_of(const std::filesystem::path& path) {
  Status status{};
  return stat(path.c_str(), &status) == 0 ? std::optional(status) : std::nullopt;
}

bool same_file(const Status& a, const Status& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

std::filesystem::path folder_of(const std::filesystem::path& path) {
  const auto file = std::filesystem::absolute(followed(path));
  return file.parent_path();
}

/// Where a file that is not there yet would be.
std::filesystem::path place_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto folder = std::filesystem::weakly_canonical(folder_of(path), error);
  return folder / followed(path).filename();
}

bool same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto found_a = status_of(a), found_b = status_of(b);
  if (found_a && S_ISCHR(found_a->st_mode)) return false;  // nothing is kept there
  if (found_a && found_b) return same_file(*found_a, *found_b);
  return !found_a && !found_b && place_of(a) == place_of(b);
}

void require_apart(const NamedPath& output, std::span<const NamedPath> others) {
  for (const NamedPath& other : others) {
    if (!same_place(output.path, other.path)) continue;
    throw std::runtime_error(fmt::format("{}: {} would be written over {}, {}; name another file", output.path.string(),
                                         output.what, other.what, other.path.string()));
  }
}

void require_apart_from_results(const NamedPath& output) {
  Status results{};
  const auto found = status_of(output.path);
  if (!found || S_ISCHR(found->st_mode) || fstat(STDOUT_FILENO, &results) != 0 || !same_file(*found, results)) return;
  throw std::runtime_error(fmt::format("{}: {} would be written where standard output goes; name another file",
                                       output.path.string(), output.what));
}

void require_permission(const std::filesystem::path& path, const std::filesystem::path& needed, int mode) {
  if (access(needed.c_str(), mode) != 0) throw std::runtime_error(write_fault(path, errno));
}

void require_place(const std::filesystem::path& path) {
  const auto found = status_of(path);
  if (!found && errno != ENOENT) throw std::runtime_error(write_fault(path, errno));
  if (found && S_ISDIR(found->st_mode)) throw std::runtime_error(write_fault(path, EISDIR));
  if (found) require_permission(path, path, W_OK);
  if (found && !S_ISREG(found->st_mode)) return;
  const auto folder = folder_of(path);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw std::runtime_error(write_fault(path, std::filesystem::exists(folder, error) ? ENOTDIR : ENOENT));
  }
  require_permission(path, folder, W_OK | X_OK);
}

}  // namespace

void require_writable(const CommandFiles& files) {
  const std::span outputs(files.outputs);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].path.empty()) throw std::runtime_error(outputs[i].what + ": its name is empty; name a file");
    require_apart(outputs[i], files.inputs);
    require_apart(outputs[i], outputs.first(i));
    require_apart_from_results(outputs[i]);
    require_place(outputs[i].path);
  }
}

void require_writable_folder(const std::filesystem::path& folder) {
  auto made = std::filesystem::absolute(folder);
  if (!made.has_filename()) made = made.parent_path();
  std::error_code error;
  while (!std::filesystem::exists(made, error) && made.has_relative_path()) made = made.parent_path();
  if (!std::filesystem::is_directory(made, error)) throw std::runtime_error(write_fault(folder, ENOTDIR));
  require_permission(folder, made, W_OK | X_OK);
}

}  // namespace greenloop
