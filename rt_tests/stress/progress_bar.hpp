#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>

namespace greenloop {

/// A line on the standard error of a terminal: how much is done, of what, and how long it will take. Nothing elsewhere.
class ProgressBar {
 public:
  explicit ProgressBar(std::uint64_t total) : total_(total), shown_(isatty(STDERR_FILENO) != 0) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() {
    if (shown_) {
      std::fprintf(stderr, "\r\033[K");
    }
  }

  void show(const char* what, std::uint64_t done) {
    const auto now = Clock::now();
    if (!shown_ || now - last_ < std::chrono::milliseconds(200)) {
      return;
    }
    last_ = now;
    const double part = static_cast<double>(done) / static_cast<double>(total_);
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    const double left = done == 0 ? 0 : seconds * (1 - part) / part;
    std::fprintf(stderr, "\r\033[K[%-40.*s] %3.0f %%  %s, %.0f s left", static_cast<int>(40 * part),
                 "########################################", 100 * part, what, left);
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t total_;
  bool shown_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_;
};

}  // namespace greenloop
