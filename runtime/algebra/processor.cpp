#include "runtime/algebra/processor.hpp"

#include <cstdint>

namespace greenloop {

#if defined(__x86_64__)
bool has_avx2() noexcept {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  std::uint32_t c = 0;
  std::uint32_t d = 0;
  asm("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  constexpr std::uint32_t avx_and_xgetbv = 3U << 27;
  if ((c & avx_and_xgetbv) != avx_and_xgetbv) {
    return false;
  }
  asm("xgetbv" : "=a"(a), "=d"(d) : "c"(0));
  if ((a & 6) != 6) {
    return false;
  }
  a = 7;
  c = 0;
  asm("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  return (b & 1U << 5) != 0;
}
#endif

}  // namespace greenloop
