#include "formats/write/aligned_bytes.hpp"

#include <algorithm>
#include <new>

#include "formats/layout.hpp"

namespace greenloop {

AlignedBytes::AlignedBytes(std::size_t size) : size_(size) {
  // aligned_alloc wants a positive multiple of the alignment
  const std::size_t whole = layout::aligned(std::max<std::size_t>(size, 1));
  data_.reset(static_cast<std::byte*>(std::aligned_alloc(layout::alignment, whole)));
  if (data_ == nullptr) throw std::bad_alloc();
  std::fill_n(data_.get(), whole, std::byte{0});
}

AlignedBytes::AlignedBytes(std::span<const std::byte> bytes) : AlignedBytes(bytes.size()) {
  std::copy(bytes.begin(), bytes.end(), data_.get());
}

}  // namespace greenloop
