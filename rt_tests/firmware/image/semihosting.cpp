#include "rt_tests/firmware/image/semihosting.hpp"

#include <cstring>

namespace greenloop::firmware {
namespace {

constexpr std::uint32_t sys_write0 = 0x04;
constexpr std::uint32_t sys_get_cmdline = 0x15;
constexpr std::uint32_t sys_exit_extended = 0x20;
constexpr std::uint32_t application_exit = 0x20026;

std::uint32_t call(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

void print_in_base(std::uint64_t number, unsigned base) {
  char text[24];
  char* at = text + sizeof text;
  *--at = '\0';
  do {
    *--at = "0123456789abcdef"[number % base];
    number /= base;
  } while (number > 0);
  print(at);
}

}  // namespace

void print(const char* text) { call(sys_write0, text); }

void print(std::uint64_t number) { print_in_base(number, 10); }

void print_hexadecimal(std::uint64_t number) { print_in_base(number, 16); }

bool command_line_contains(const char* word) {
  char line[128] = {};
  const struct {
    char* text;
    std::uint32_t size;
  } block{line, sizeof line};
  return call(sys_get_cmdline, &block) == 0 && std::strstr(line, word) != nullptr;
}

void exit_with(int status) {
  const std::uint32_t block[] = {application_exit, static_cast<std::uint32_t>(status)};
  for (;;) {
    call(sys_exit_extended, block);
  }
}

}  // namespace greenloop::firmware
