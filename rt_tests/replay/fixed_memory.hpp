#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace greenloop {

/// Addresses begin..end-1.
struct AddressRange {
  std::uint64_t begin, end;
};

/// Zeroed memory at addresses of the caller's choice, given back at the end. Linux only.
class FixedMemory {
 public:
  /// Throws std::runtime_error if some of it is in use.
  FixedMemory(AddressRange one, AddressRange other);
  FixedMemory(const FixedMemory&) = delete;
  FixedMemory& operator=(const FixedMemory&) = delete;
  ~FixedMemory();

 private:
  void map(AddressRange pages);
  void unmap() noexcept;

  std::vector<AddressRange> mapped_;
};

}  // namespace greenloop
