#include "sim_hw/guard/allocation_guard.hpp"

#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
#define GREENLOOP_SANITIZER_HOOKS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define GREENLOOP_SANITIZER_HOOKS 1
#endif
#endif

namespace greenloop::allocation_guard {
namespace {

thread_local constinit bool armed = false;
thread_local constinit std::uint64_t events = 0;

void note() { events += armed ? 1 : 0; }

}  // namespace

void arm() noexcept { armed = true; }
void disarm() noexcept { armed = false; }
std::uint64_t count() noexcept { return events; }

}  // namespace greenloop::allocation_guard

using greenloop::allocation_guard::note;

#ifdef GREENLOOP_SANITIZER_HOOKS

// the sanitizer's own interface; not every compiler ships its header
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));

namespace {
const int installed = __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { note(); },
                                                                [](const volatile void*) { note(); });
}  // namespace

#else

// NOLINTBEGIN(bugprone-reserved-identifier): glibc's own names of its allocator
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept {
  note();
  return __libc_malloc(size);
}
__attribute__((visibility("default"))) void* calloc(std::size_t count, std::size_t size) noexcept {
  note();
  return __libc_calloc(count, size);
}
__attribute__((visibility("default"))) void* realloc(void* memory, std::size_t size) noexcept {
  note();
  return __libc_realloc(memory, size);
}
__attribute__((visibility("default"))) void* memalign(std::size_t alignment, std::size_t size) noexcept {
  note();
  return __libc_memalign(alignment, size);
}
__attribute__((visibility("default"))) void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  note();
  return __libc_memalign(alignment, size);
}
__attribute__((visibility("default"))) int posix_memalign(void** memory, std::size_t alignment,
                                                          std::size_t size) noexcept {
  note();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
__attribute__((visibility("default"))) void free(void* memory) noexcept {
  note();
  __libc_free(memory);
}
}
// NOLINTEND(bugprone-reserved-identifier)

#endif
