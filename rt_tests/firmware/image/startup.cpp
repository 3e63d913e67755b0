// Vector table and reset: copies .data, clears .bss, paints the stack, enables the floating-point unit, calls main.
#include <cstddef>
#include <cstdint>

#include "rt_tests/firmware/image/semihosting.hpp"
#include "rt_tests/firmware/image/stack.hpp"

extern "C" {
extern std::uint32_t stack_begin[], stack_end[], data_begin[], data_end[], data_image[], bss_begin[], bss_end[];

int main();

[[noreturn]] void reset() {
  auto& coprocessor_access = *reinterpret_cast<volatile std::uint32_t*>(0xe000ed88);
  coprocessor_access = 0xfU << 20;
  asm volatile("dsb\n isb" ::: "memory");
  const std::uint32_t* from = data_image;
  for (std::uint32_t* to = data_begin; to != data_end;) {
    *to++ = *from++;
  }
  for (std::uint32_t* to = bss_begin; to != bss_end;) {
    *to++ = 0;
  }
  greenloop::firmware::paint_stack();
  greenloop::firmware::exit_with(main());
}

[[noreturn]] void fault() {
  greenloop::firmware::print("fault\n");
  greenloop::firmware::exit_with(99);
}

void timer_interrupt();
}

namespace {

using Handler = void (*)();

struct Vectors {
  std::uint32_t* stack;
  Handler handler[15];
};

[[gnu::section(".vectors"), gnu::used]] constexpr Vectors vectors = {
    stack_end,
    {reset, fault, fault, fault, fault, fault, nullptr, nullptr, nullptr, nullptr, fault, fault, nullptr, fault,
     timer_interrupt}};

}  // namespace
