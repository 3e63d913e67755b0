#include "offline/pipeline/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "formats/output/streams.hpp"

namespace greenloop::offline {
namespace {

constexpr int bar_width = 30;
constexpr std::chrono::milliseconds redraw_interval(100), log_interval(30'000);

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string duration_text(double seconds) {
  return seconds < 60
             ? fmt::format("{:.0f} s", seconds)
             : fmt::format("{:d} min {:02d} s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

}  // namespace

ProgressBar::ProgressBar(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressBar::begin(std::string_view stage) {
  if (running_) {
    end();
  }
  stage_ = stage;
  running_ = true;
  first_fraction_ = -1;
  started_ = drawn_ = Clock::now();
  if (terminal_) draw(0, {});
}

void ProgressBar::update(double fraction, std::string_view detail) {
  if (first_fraction_ < 0) {
    first_fraction_ = fraction;
  }
  if (Clock::now() - drawn_ >= (terminal_ ? redraw_interval : log_interval)) {
    draw(std::clamp(fraction, 0.0, 1.0), detail);
  }
}

void ProgressBar::end(std::string_view note) {
  const double seconds = seconds_between(started_, Clock::now());
  stages_.push_back({stage_, seconds});
  running_ = false;
  if (!quiet_) {
    say_raw(terminal_ ? "\r\033[K" : "");
    say(fmt::format("{:<12} {:>6.1f} s  {}\n", stage_, seconds, note));
  }
}

void ProgressBar::warn(const std::string& what) {
  warnings_.push_back(what);
  say("warning: " + what + "\n");
}

void ProgressBar::draw(double fraction, std::string_view detail) {
  if (quiet_) return;
  drawn_ = Clock::now();
  const int filled = static_cast<int>(fraction * bar_width);
  const double covered = fraction - std::max(first_fraction_, 0.0);
  const double remaining = covered > 0 ? seconds_between(started_, drawn_) * (1 - fraction) / covered : -1;
  const std::string left = remaining >= 0 ? fmt::format(", {} left", duration_text(remaining)) : "";
  if (!terminal_) {
    say(fmt::format("{:<12} {:3.0f} %{} {}\n", stage_, 100 * fraction, left, detail));
    return;
  }
  say_raw("\r\033[K");
  say(fmt::format("{:<12} [{:#<{}}{: <{}}] {:3.0f} %{} {}", stage_, "", filled, "", bar_width - filled, 100 * fraction,
                  left, detail));
}

}  // namespace greenloop::offline
