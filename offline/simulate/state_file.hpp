#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace greenloop::offline {

/// States of a simulator from which orbits may start, beside the trajectories that they are of: what sampling goes on
/// from after a kill. Of this machine and program; it can be deleted when no more orbits are wanted.
class StateFile {
 public:
  /// Goes on with what is there, but for states of frames from `frames` on, which belong to an orbit that was not
  /// whole; makes a file if there is none. Throws std::runtime_error if it cannot be used, or holds states of another
  /// count of numbers.
  StateFile(std::filesystem::path path, std::size_t numbers, std::uint64_t frames);

  /// Frames that the states belong to, growing.
  [[nodiscard]] const std::vector<std::uint64_t>& frames() const { return frames_; }

  /// It is with the system when this returns.
  void append(std::uint64_t frame, std::span<const double> state);
  [[nodiscard]] std::vector<double> read(std::size_t index);

 private:
  [[nodiscard]] std::uint64_t record_bytes() const { return sizeof(std::uint64_t) + numbers_ * sizeof(double); }
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_;
  std::size_t numbers_;
  std::fstream file_;
  std::vector<std::uint64_t> frames_;
};

}  // namespace greenloop::offline
