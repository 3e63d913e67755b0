#pragma once

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace greenloop {

/// Where what is written to `path` goes: symbolic links followed, also one to nothing. Throws std::runtime_error if
/// there is no end of them.
[[nodiscard]] std::filesystem::path followed(const std::filesystem::path& path);

/// Whether something stands there that is neither a file nor a folder, a device or pipe for instance: it is written
/// through, never replaced.
[[nodiscard]] bool is_special(const std::filesystem::path& path);

/// "PATH: cannot be written: REASON" with what mends it; errno values.
[[nodiscard]] std::string write_fault(const std::filesystem::path& path, int reason);

/// Keeps INT, TERM and HUP waiting while in scope.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

/// A file that has no name until it is whole, or, on file systems that know none, a name that nobody else has:
/// .greenloop-*.part beside its target, removed again unless the program is killed (signals that can wait do).
class PendingFile {
 public:
  /// In the folder of `target`, which must not be special. With `named` it has a name in any case, for libraries that
  /// do not open what has none; `ending` ends it. Throws std::runtime_error naming the target and the reason.
  explicit PendingFile(const std::filesystem::path& target, bool named = false, std::string_view ending = ".part");
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// By which it can be opened meanwhile.
  [[nodiscard]] std::filesystem::path name() const;

  /// Writes all bytes. Throws std::runtime_error.
  void write(std::span<const std::byte> bytes);

  /// Makes it, whole and on the disk, what its target's name stands for. Throws std::runtime_error, and the target
  /// is as before.
  void publish();

  /// The same, but only if nothing stands under that name: false, and it still has none, if something does.
  [[nodiscard]] bool publish_new();

 private:
  void sync();
  [[nodiscard]] bool has_linked(const std::filesystem::path& to);
  void rename_part();
  void finish();

  std::filesystem::path target_;  ///< followed
  std::filesystem::path part_;    ///< empty: no name
  int descriptor_ = -1;
  std::optional<SignalsHeld> held_;
};

/// A file that is written in parts, but whole or not at all: from close() on `path` has the new bytes, before it has
/// what it had. Links are followed; what is special is written through. Throws std::runtime_error naming the file, the
/// reason and the remedy.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::span<const std::byte> bytes);
  /// Gathered, so that lines may come one by one.
  void write(std::string_view text);
  void close();

 private:
  void write_gathered();

  std::filesystem::path path_;
  std::string gathered_;
  std::optional<PendingFile> pending_;
  int special_ = -1;  ///< the descriptor of what is written through
};

/// All of it at once.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace greenloop
