#include "formats/store/hdf5_fault.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

namespace greenloop {
namespace {

herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* text) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

/// "file write failed: No space left on device" of what HDF5 says at length.
std::string shortened(const std::string& text) {
  const std::string mark = "error message = '";
  const auto begin = text.find(mark);
  if (begin == std::string::npos) return text;
  const auto end = text.find('\'', begin + mark.size());
  return text.substr(0, text.find_first_of(",:")) + ": " + text.substr(begin + mark.size(), end - begin - mark.size());
}

bool says(const std::string& reason, std::string_view part) { return reason.find(part) != std::string::npos; }

std::string remedy(const std::filesystem::path& path, const std::string& reason) {
  if (is_locked(path)) return "another process uses it: wait until it ends, or name another file";
  if (says(reason, "unable to lock")) {
    return "its file system knows no locks: name a store on another one, or set HDF5_USE_FILE_LOCKING=FALSE and see to "
           "it that one process alone uses it";
  }
  if (access(path.c_str(), R_OK | W_OK) != 0) return "mend its permissions";
  return "it is damaged or no HDF5 file: name another, or let `greenloop build --overwrite-store` replace it";
}

}  // namespace

void start_hdf5() {
  [[maybe_unused]] static const bool started = [] {
    (void)H5dont_atexit();
    return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  }();
}

std::string hdf5_fault() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
  return text.empty() ? "HDF5 does not say why" : shortened(text);
}

bool is_locked(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  (void)close(file);
  return locked;
}

std::string open_fault(const std::filesystem::path& path, const std::string& reason) {
  return path.string() + ": cannot be opened: " + reason + "; " + remedy(path, reason);
}

}  // namespace greenloop
