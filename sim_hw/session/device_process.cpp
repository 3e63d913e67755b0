#include "sim_hw/session/device_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "formats/output/streams.hpp"

namespace greenloop {
namespace {

void close_end(int& end) {
  if (end >= 0) (void)close(end);
  end = -1;
}

/// The whole life of the child.
[[noreturn]] void child_main(const std::function<void()>& life, std::span<const std::byte> counted, int start,
                             int summary) {
  (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
  // a terminal interrupts both; the parent ends this one
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) (void)std::signal(signal, SIG_IGN);
  int status = 1;
  try {
    char go = 0;
    if (read(start, &go, 1) == 1) {
      life();
      status = write(summary, counted.data(), counted.size()) == static_cast<ssize_t>(counted.size()) ? 0 : 1;
    }
  } catch (const std::exception& error) {
    say(std::string("greenloop-loop: ") + error.what() + "\n");
  }
  _exit(status);
}

}  // namespace

DeviceProcess::DeviceProcess(const std::function<void()>& life, std::span<std::byte> summary) : summary_(summary) {
  if (pipe(start_pipe_) != 0 || pipe(summary_pipe_) != 0) throw std::runtime_error("device: no pipe for its process");
  child_ = fork();
  if (child_ < 0) throw std::runtime_error("device: its process cannot be started");
  if (child_ == 0) {
    close_end(start_pipe_[1]);
    close_end(summary_pipe_[0]);
    child_main(life, summary_, start_pipe_[0], summary_pipe_[1]);
  }
  close_end(start_pipe_[0]);
  close_end(summary_pipe_[1]);
}

DeviceProcess::~DeviceProcess() {
  if (child_ > 0) {
    (void)kill(child_, SIGKILL);
    (void)waitpid(child_, nullptr, 0);
  }
  close_end(start_pipe_[1]);
  close_end(summary_pipe_[0]);
}

void DeviceProcess::start() {
  if (write(start_pipe_[1], "g", 1) != 1) throw std::runtime_error("device: its process cannot be reached");
}

bool DeviceProcess::ended() {
  if (child_ < 0) return true;
  int status = 0;
  if (waitpid(child_, &status, WNOHANG) != child_) return false;
  child_ = -1;
  read_summary(status);
  return true;
}

void DeviceProcess::read_summary(int exit_status) {
  const bool well = WIFEXITED(exit_status) && WEXITSTATUS(exit_status) == 0;
  if (!well || read(summary_pipe_[0], summary_.data(), summary_.size()) != static_cast<ssize_t>(summary_.size())) {
    throw std::runtime_error("device: its process ended early; no result");
  }
}

}  // namespace greenloop
