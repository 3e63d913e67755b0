#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace greenloop {

/// Hands values from one thread to one other and keeps only the newest: a triple buffer. Both sides are wait-free,
/// without heap, lock or system call, so both may be called in the loop. Exactly one thread puts, exactly one takes.
template <typename T>
class Newest {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Makes `value` the newest; one that was not taken before is dropped. Work: one copy.
  void put(const T& value) noexcept {
    buffer_[back_] = value;
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | fresh), std::memory_order_acq_rel) & index;
  }

  /// Copies the newest value out, unless it was taken before: then false and `value` stays. Work: one copy.
  [[nodiscard]] bool take(T& value) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;
    value = buffer_[front_];
    return true;
  }

 private:
  static constexpr std::uint8_t fresh = 4;
  static constexpr std::uint8_t index = 3;

  std::array<T, 3> buffer_{};
  alignas(64) std::uint8_t back_ = 0;                ///< the writer's
  alignas(64) std::atomic<std::uint8_t> middle_{1};  ///< between them, with the mark `fresh`
  alignas(64) std::uint8_t front_ = 2;               ///< the reader's
};

}  // namespace greenloop
