#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace greenloop {

/// Carves arrays out of one piece of memory. Without memory it only counts, so that the routine that places is the one
/// that sizes. Memory starts zeroed; debug builds fill it with NaN instead and put a red zone behind every array.
class Arena {
 public:
  static constexpr std::uint64_t alignment = 64;

  explicit Arena(std::byte* memory = nullptr) : memory_(memory) {}

  /// `count` elements on a 64-byte boundary; null while counting.
  template <class T>
  [[nodiscard]] T* take(std::uint64_t count) {
    return static_cast<T*>(take_bytes(count * sizeof(T), poison));
  }

  /// The same, zero in every build.
  template <class T>
  [[nodiscard]] T* take_zeroed(std::uint64_t count) {
    return static_cast<T*>(take_bytes(count * sizeof(T), 0));
  }

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] const std::byte* last_red_zone() const { return last_red_zone_; }

  /// Whether no red zone up to `last_red_zone` has been written to. Work: one unit per array; always true in release.
  [[nodiscard]] static bool intact(const std::byte* last_red_zone) {
    while (last_red_zone != nullptr) {
      RedZone zone;
      std::memcpy(&zone, last_red_zone, sizeof zone);
      if (zone.mark[0] != red_mark || std::memcmp(zone.mark, zone.mark + 1, sizeof zone.mark - sizeof red_mark) != 0) {
        return false;
      }
      last_red_zone = zone.previous;
    }
    return true;
  }

 private:
  static constexpr std::uint64_t red_mark = 0xfeedfacecafebeef;
  struct RedZone {
    std::uint64_t mark[7];
    const std::byte* previous;
  };
  static_assert(sizeof(RedZone) <= alignment);

#ifdef NDEBUG
  static constexpr int poison = 0;
  static constexpr bool red_zones = false;
#else
  static constexpr int poison = 0xff;
  static constexpr bool red_zones = true;
#endif

  void* take_bytes(std::uint64_t size, int fill) {
    std::byte* place = memory_ == nullptr ? nullptr : memory_ + bytes_;
    bytes_ += (size + alignment - 1) / alignment * alignment;
    if (place != nullptr) {
      std::memset(place, fill, static_cast<std::size_t>(size));
    }
    if (red_zones) {
      if (memory_ != nullptr) {
        const RedZone zone{{red_mark, red_mark, red_mark, red_mark, red_mark, red_mark, red_mark}, last_red_zone_};
        last_red_zone_ = memory_ + bytes_;
        std::memcpy(memory_ + bytes_, &zone, sizeof zone);
      }
      bytes_ += alignment;
    }
    return place;
  }

  std::byte* memory_;
  std::uint64_t bytes_ = 0;
  const std::byte* last_red_zone_ = nullptr;
};

}  // namespace greenloop
