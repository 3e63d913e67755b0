#pragma once

namespace greenloop {

#if defined(__x86_64__)
/// Whether the processor has AVX2 and the operating system keeps its registers. Start-up.
[[nodiscard]] bool has_avx2() noexcept;
#endif

}  // namespace greenloop
