#include "sim_hw/guard/system_call_guard.hpp"

#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace greenloop::system_call_guard {
namespace {

constexpr int set_syscall_user_dispatch = 59;  // PR_SET_SYSCALL_USER_DISPATCH
constexpr unsigned long dispatch_on = 1;
constexpr char allow = 0;
constexpr char block = 1;

volatile char selector = allow;
volatile std::uint64_t events = 0;
volatile long last_number = -1;

// carries out the call that was caught, as the thread meant it
void carry_out(const siginfo_t& info, ucontext_t& context) {
#if defined(__x86_64__)
  greg_t* r = context.uc_mcontext.gregs;
  const long result = syscall(info.si_syscall, r[REG_RDI], r[REG_RSI], r[REG_RDX], r[REG_R10], r[REG_R8], r[REG_R9]);
  r[REG_RAX] = result == -1 ? -errno : result;
#elif defined(__aarch64__)
  auto* r = context.uc_mcontext.regs;
  const long result = syscall(info.si_syscall, r[0], r[1], r[2], r[3], r[4], r[5]);
  r[0] = static_cast<unsigned long>(result == -1 ? -errno : result);
#endif
}

void caught(int, siginfo_t* info, void* context) {
  selector = allow;
  const int kept = errno;
  events = events + 1;
  last_number = info->si_syscall;
  carry_out(*info, *static_cast<ucontext_t*>(context));
  errno = kept;
}

}  // namespace

bool install() noexcept {
#if defined(__x86_64__) || defined(__aarch64__)
  struct sigaction action {};
  action.sa_sigaction = caught;
  action.sa_flags = SA_SIGINFO;
  return sigaction(SIGSYS, &action, nullptr) == 0 &&
         prctl(set_syscall_user_dispatch, dispatch_on, 0, 0, &selector) == 0;
#else
  return false;
#endif
}

void arm() noexcept { selector = block; }
void disarm() noexcept { selector = allow; }
std::uint64_t count() noexcept { return events; }
long last() noexcept { return last_number; }

}  // namespace greenloop::system_call_guard
