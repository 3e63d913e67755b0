#include "sim_hw/guard/instruction_counter.hpp"

#include <csignal>

namespace greenloop::instruction_counter {
namespace {

volatile std::uint64_t instructions = 0;
std::uint64_t own = 0;  // instructions of start and stop

void trapped(int) { instructions = instructions + 1; }

#if defined(__x86_64__)
// 128 bytes below the stack pointer belong to the function
[[gnu::always_inline]] inline void set_trap_flag() {
  asm volatile("lea -128(%%rsp), %%rsp\n pushfq\n orq $0x100, (%%rsp)\n popfq\n lea 128(%%rsp), %%rsp" ::
                   : "memory", "cc");
}

[[gnu::always_inline]] inline void clear_trap_flag() {
  asm volatile("lea -128(%%rsp), %%rsp\n pushfq\n andq $~0x100, (%%rsp)\n popfq\n lea 128(%%rsp), %%rsp" ::
                   : "memory", "cc");
}
#else
void set_trap_flag() {}
void clear_trap_flag() {}
#endif

}  // namespace

bool install() noexcept {
#if defined(__x86_64__)
  if (std::signal(SIGTRAP, trapped) == SIG_ERR) {
    return false;
  }
  own = 0;
  start();
  own = stop();
  return own > 0;
#else
  return false;
#endif
}

void start() noexcept {
  instructions = 0;
  set_trap_flag();
}

std::uint64_t stop() noexcept {
  clear_trap_flag();
  return instructions - own;
}

}  // namespace greenloop::instruction_counter
