#include "sim_hw/session/interruption.hpp"

#include <csignal>
#include <initializer_list>

namespace greenloop {
namespace {

volatile std::sig_atomic_t received = 0;

void receive(int signal) { received = signal; }

}  // namespace

void await_interruption() {
  struct sigaction action {};
  action.sa_handler = receive;
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;  // nohup
    (void)sigaction(signal, &action, nullptr);
  }
}

int interruption() noexcept { return received; }

}  // namespace greenloop
