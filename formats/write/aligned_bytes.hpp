#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>

namespace greenloop {

/// Owning bytes at a 64-byte boundary, zero at first, as verify and Model::open want them. Offline only.
class AlignedBytes {
 public:
  AlignedBytes() = default;
  /// Throws std::bad_alloc if there is no such memory.
  explicit AlignedBytes(std::size_t size);
  /// A copy of `bytes`.
  explicit AlignedBytes(std::span<const std::byte> bytes);

  [[nodiscard]] std::byte* data() { return data_.get(); }
  [[nodiscard]] const std::byte* data() const { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<const std::byte> span() const { return {data_.get(), size_}; }

 private:
  struct Free {
    void operator()(std::byte* data) const { std::free(data); }
  };
  std::unique_ptr<std::byte[], Free> data_;
  std::size_t size_ = 0;
};

}  // namespace greenloop
