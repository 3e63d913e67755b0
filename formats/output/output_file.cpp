#include "formats/output/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace greenloop {
namespace {

constexpr int most_links = 40;  // as Linux

[[noreturn]] void fail(const std::filesystem::path& path, int reason) {
  throw std::runtime_error(write_fault(path, reason));
}

std::string remedy(const std::filesystem::path& path, int reason) {
  switch (reason) {
    case ENOENT:
    case ENOTDIR:
      return "make its folder, or name another";
    case ENOSPC:
    case EDQUOT:
      return "make room there, or name a file on another disk";
    case EFBIG:
      return "raise the limit of file size (ulimit -f), or name a file on another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return fmt::format("mend the permissions of {}, or name another folder", path.parent_path().string());
    case EISDIR:
      return "name a file in it";
    default:
      return "name another file";
  }
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// The reason why not everything is on the disk, or 0; what is no disk has none.
int sync_descriptor(int descriptor) {
  const bool synced = fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS;
  return synced ? 0 : errno;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

std::filesystem::path part_beside(const std::filesystem::path& file, std::string_view ending) {
  std::random_device random;
  return folder_of(file) / fmt::format(".greenloop-{:08x}{:08x}{}", random(), random(), ending);
}

/// As the file that is replaced, or as the user's mask says.
void copy_mode(const std::filesystem::path& from, int descriptor) {
  struct stat old {};
  if (stat(from.c_str(), &old) == 0) (void)fchmod(descriptor, old.st_mode & 07777U);
}

/// A rename is on the disk when its folder is.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)fsync(descriptor);
  (void)::close(descriptor);
}

}  // namespace

std::string write_fault(const std::filesystem::path& path, int reason) {
  return fmt::format("{}: cannot be written: {}; {}", path.string(), std::generic_category().message(reason),
                     remedy(std::filesystem::absolute(path), reason));
}

std::filesystem::path followed(const std::filesystem::path& path) {
  std::filesystem::path end = path;
  std::error_code error;
  for (int links = 0; std::filesystem::is_symlink(end, error); ++links) {
    if (links == most_links) fail(path, ELOOP);
    end = end.parent_path() / std::filesystem::read_symlink(end);
  }
  return end;
}

bool is_special(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

SignalsHeld::SignalsHeld() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

PendingFile::PendingFile(const std::filesystem::path& target, bool named, std::string_view ending)
    : target_(followed(target)) {
  if (std::filesystem::is_directory(target_)) fail(target, EISDIR);
  if (!named) descriptor_ = open(folder_of(target_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {  // asked for, or a file system without nameless files
    held_.emplace();
    part_ = part_beside(target_, ending);
    descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  }
  if (descriptor_ < 0) fail(target, errno);
  copy_mode(target_, descriptor_);
}

PendingFile::~PendingFile() {
  if (descriptor_ >= 0) (void)::close(descriptor_);
  if (!part_.empty()) (void)unlink(part_.c_str());
}

std::filesystem::path PendingFile::name() const {
  return part_.empty() ? std::filesystem::path(fmt::format("/proc/self/fd/{}", descriptor_)) : part_;
}

void PendingFile::write(std::span<const std::byte> bytes) { write_all(descriptor_, bytes, target_); }

void PendingFile::sync() {
  if (const int reason = sync_descriptor(descriptor_); reason != 0) fail(target_, reason);
}

void PendingFile::finish() {
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(target_, errno);
  sync_folder(folder_of(target_));
}

bool PendingFile::has_linked(const std::filesystem::path& to) {
  sync();
  if (linkat(AT_FDCWD, name().c_str(), AT_FDCWD, to.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
  if (errno != EEXIST) fail(target_, errno);
  return false;
}

void PendingFile::rename_part() {
  if (rename(part_.c_str(), target_.c_str()) != 0) fail(target_, errno);
  part_.clear();
}

bool PendingFile::publish_new() {
  const SignalsHeld held;
  if (part_.empty()) {
    if (!has_linked(target_)) return false;
  } else {
    sync();
    if (std::filesystem::exists(std::filesystem::symlink_status(target_))) return false;
    rename_part();
  }
  finish();
  return true;
}

void PendingFile::publish() {
  const SignalsHeld held;
  if (part_.empty() && !has_linked(target_)) {
    const std::filesystem::path part = part_beside(target_, ".part");
    if (!has_linked(part)) fail(target_, EEXIST);
    part_ = part;
  }
  sync();
  if (!part_.empty()) rename_part();
  finish();
}

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  if (!is_special(path)) {
    pending_.emplace(path);
    return;
  }
  special_ = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (special_ < 0) fail(path, errno);
}

OutputFile::~OutputFile() {
  if (special_ >= 0) (void)::close(special_);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  write_gathered();
  if (pending_) {
    pending_->write(bytes);
  } else {
    write_all(special_, bytes, path_);
  }
}

void OutputFile::write(std::string_view text) {
  constexpr std::size_t enough = std::size_t{1} << 20U;
  gathered_ += text;
  if (gathered_.size() >= enough) write_gathered();
}

void OutputFile::write_gathered() {
  const std::string text = std::exchange(gathered_, {});
  if (!text.empty()) write(std::as_bytes(std::span(text)));
}

void OutputFile::close() {
  write_gathered();
  if (pending_) {
    pending_->publish();
    return;
  }
  if (const int reason = sync_descriptor(special_); reason != 0) fail(path_, reason);
  if (::close(std::exchange(special_, -1)) != 0) fail(path_, errno);
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.close();
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace greenloop
