#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/memory/arena.hpp"

namespace greenloop {

/// An object with a `carve(arena, count)`, in memory of its own.
template <class T>
class Carved {
 public:
  explicit Carved(std::uint32_t count) {
    Arena counting;
    object_.carve(counting, count);
    memory_.resize((counting.bytes() + 2 * Arena::alignment) / sizeof(Unit));
    auto* const begin = reinterpret_cast<std::byte*>(memory_.data());
    const auto misaligned = reinterpret_cast<std::uintptr_t>(begin) % Arena::alignment;
    Arena arena(begin + (Arena::alignment - misaligned) % Arena::alignment);
    object_.carve(arena, count);
  }
  Carved(const Carved&) = delete;  // it refers to its memory
  Carved& operator=(const Carved&) = delete;

  [[nodiscard]] T& operator*() { return object_; }
  [[nodiscard]] T* operator->() { return &object_; }

 private:
  struct Unit {
    std::byte bytes[64];
  };
  std::vector<Unit> memory_;
  T object_;
};

}  // namespace greenloop
