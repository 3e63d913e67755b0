#include "sim_hw/guard/mutex_guard.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>

namespace greenloop::mutex_guard {
namespace {

thread_local constinit bool armed = false;
thread_local constinit std::uint64_t events = 0;

// the C library's own function of that name, after counting the call
template <class Function>
Function* counted(Function*& original, const char* name) {
  events += armed ? 1 : 0;
  if (original == nullptr) {
    original = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
  }
  return original;
}

}  // namespace

void arm() noexcept { armed = true; }
void disarm() noexcept { armed = false; }
std::uint64_t count() noexcept { return events; }

}  // namespace greenloop::mutex_guard

using greenloop::mutex_guard::counted;

#define GREENLOOP_COUNTED(name, Lock)                                   \
  __attribute__((visibility("default"))) int name(Lock lock) noexcept { \
    static int (*original)(Lock) = nullptr;                             \
    return counted(original, #name)(lock);                              \
  }

extern "C" {
GREENLOOP_COUNTED(pthread_mutex_lock, pthread_mutex_t*)
GREENLOOP_COUNTED(pthread_mutex_trylock, pthread_mutex_t*)
GREENLOOP_COUNTED(pthread_rwlock_rdlock, pthread_rwlock_t*)
GREENLOOP_COUNTED(pthread_rwlock_wrlock, pthread_rwlock_t*)
GREENLOOP_COUNTED(pthread_spin_lock, pthread_spinlock_t*)

__attribute__((visibility("default"))) int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* lock) {
  static int (*original)(pthread_cond_t*, pthread_mutex_t*) = nullptr;
  return counted(original, "pthread_cond_wait")(condition, lock);
}
__attribute__((visibility("default"))) int sem_wait(sem_t* semaphore) {
  static int (*original)(sem_t*) = nullptr;
  return counted(original, "sem_wait")(semaphore);
}
}
