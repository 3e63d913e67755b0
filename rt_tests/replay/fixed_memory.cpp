#include "rt_tests/replay/fixed_memory.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace greenloop {
namespace {

AddressRange whole_pages(AddressRange range) {
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return {range.begin / page * page, (range.end + page - 1) / page * page};
}

void* pointer(std::uint64_t address) { return std::bit_cast<void*>(static_cast<std::uintptr_t>(address)); }

}  // namespace

FixedMemory::FixedMemory(AddressRange one, AddressRange other) {
  const AddressRange a = whole_pages(one), b = whole_pages(other);
  if (a.begin < b.end && b.begin < a.end) {
    map({std::min(a.begin, b.begin), std::max(a.end, b.end)});
  } else {
    map(a);
    map(b);
  }
}

FixedMemory::~FixedMemory() { unmap(); }

void FixedMemory::map(AddressRange pages) {
  const std::size_t bytes = static_cast<std::size_t>(pages.end - pages.begin);
  void* const got = mmap(pointer(pages.begin), bytes, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
  if (got == pointer(pages.begin)) {
    mapped_.push_back(pages);
    return;
  }
  if (got != MAP_FAILED) munmap(got, bytes);
  unmap();
  throw std::runtime_error(
      fmt::format("the addresses {:#x} to {:#x} of the recorded body are in use here; programs are loaded at random "
                  "addresses: try again",
                  pages.begin, pages.end));
}

void FixedMemory::unmap() noexcept {
  for (const AddressRange& pages : mapped_) {
    munmap(pointer(pages.begin), static_cast<std::size_t>(pages.end - pages.begin));
  }
}

}  // namespace greenloop
