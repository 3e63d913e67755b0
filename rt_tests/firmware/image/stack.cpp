#include "rt_tests/firmware/image/stack.hpp"

#include <cstdint>

extern "C" std::uint32_t stack_begin[], stack_end[];

namespace greenloop::firmware {
namespace {

constexpr std::uint32_t paint = 0xa5a5a5a5;

}  // namespace

void paint_stack() {
  const auto* here = static_cast<const std::uint32_t*>(__builtin_frame_address(0)) - 16;
  for (volatile std::uint32_t* at = stack_begin; at < here; ++at) {
    *at = paint;
  }
}

std::size_t deepest_stack() {
  const std::uint32_t* at = stack_begin;
  while (at != stack_end && *at == paint) {
    ++at;
  }
  return sizeof(std::uint32_t) * static_cast<std::size_t>(stack_end - at);
}

}  // namespace greenloop::firmware
