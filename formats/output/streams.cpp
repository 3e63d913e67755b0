#include "formats/output/streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string>
#include <system_error>

#include "formats/output/printable.hpp"

namespace greenloop {
namespace {

bool told = false;  ///< that results were lost

[[noreturn]] void fail_results(int reason) {
  told = true;
  const std::string cause = reason != 0 ? ": " + std::generic_category().message(reason) : "";
  throw std::runtime_error("standard output: the results cannot be written" + cause);
}

}  // namespace

void prepare_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // the lowest free number is taken, which is this stream's; a folder can be neither read nor written
    if (fcntl(stream, F_GETFD) < 0) (void)open("/", O_RDONLY | O_DIRECTORY);
  }
  (void)std::signal(SIGPIPE, SIG_IGN);
  (void)std::signal(SIGXFSZ, SIG_IGN);
}

void say_raw(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void say(std::string_view text) noexcept {
  try {
    say_raw(printable(text));
  } catch (const std::exception&) {
    say_raw("out of memory\n");
  }
}

void print_result(std::string_view text) {
  const std::string shown = printable(text);
  if (std::fwrite(shown.data(), 1, shown.size(), stdout) != shown.size()) fail_results(errno);
}

void finish_results() {
  std::cout.flush();
  errno = 0;
  const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || std::cout.bad();
  const int reason = errno;
  // some file systems report only now what they could not write
  const bool closed = close(STDOUT_FILENO) == 0;
  if (told) return;
  if (lost) fail_results(reason);
  if (!closed) fail_results(errno);
}

}  // namespace greenloop
