#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace greenloop {

/// The 64-bit hash FNV-1a of everything added so far (Fowler, Noll, Vo; draft-eastlake-fnv). Loop-safe.
class Fnv1a {
 public:
  void add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) hash_ = (hash_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace greenloop
