#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "runtime/algebra/float4.hpp"

namespace greenloop::bench {

/// Reads the same memory from its beginning to its end, in vectors of four floats as the loop's code does: what a
/// kernel that touches as many bytes could reach if it did nothing else.
class ReadStream {
 public:
  explicit ReadStream(std::size_t bytes);

  [[nodiscard]] std::size_t bytes() const { return memory_.size() * sizeof(Float4); }

  /// Bytes per microsecond, of one reading after another, thread CPU time.
  [[nodiscard]] double measure();

 private:
  std::vector<Float4> memory_;
  float sum_ = 0;
};

/// Streams out of a first-level, a second-level and a third-level cache of common size, and out of memory.
inline constexpr std::array<std::size_t, 4> stream_bytes = {std::size_t{16} << 10, std::size_t{1} << 20,
                                                            std::size_t{16} << 20, std::size_t{256} << 20};

/// Multiplications and additions per microsecond of vectors of four floats that nothing waits for.
[[nodiscard]] double measure_flops();

}  // namespace greenloop::bench
