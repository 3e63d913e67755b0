#include "rt_tests/stress/guarded_steps.hpp"

#include <sys/mman.h>
#include <unistd.h>

namespace greenloop {
namespace {

std::size_t page_bytes() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

}  // namespace

std::array<NamedCount, 6> named(const Violations& violations) {
  return {{{"work_overruns", violations.work_overruns},
           {"wrong_answers", violations.wrong_answers},
           {"allocations", violations.allocations},
           {"locks", violations.locks},
           {"syscalls", violations.system_calls},
           {"minor_faults", violations.minor_faults}}};
}

std::string verdict_of(const Violations& violations) {
  if (violations.sum() == 0) {
    return "HELD";
  }
  std::string text = "VIOLATED";
  const char* before = ": ";
  for (const auto& [name, count] : named(violations)) {
    if (count > 0) {
      text += before + std::string(name) + " " + std::to_string(count);
      before = ", ";
    }
  }
  return text;
}

bool GuardedSteps::prepare() {
  {
    const std::lock_guard lock(mutex_);  // so that the guard has looked up the real function, which may allocate
  }
  page_.reset(static_cast<char*>(std::aligned_alloc(page_bytes(), page_bytes())));
  return system_call_guard::install();
}

void GuardedSteps::prepare_fault(bool is_faulty) {
  if (is_faulty && fault_ == InjectedFault::page_fault) {
    madvise(page_.get(), page_bytes(), MADV_DONTNEED);
  }
}

void GuardedSteps::commit_fault() {
  switch (fault_) {
    case InjectedFault::none:
    case InjectedFault::overrun:
      break;
    case InjectedFault::allocation:
      leak_.reset(new int(1));
      break;
    case InjectedFault::lock: {
      const std::lock_guard lock(mutex_);
      break;
    }
    case InjectedFault::system_call:
      static_cast<void>(getppid());
      break;
    case InjectedFault::page_fault:
      *static_cast<volatile char*>(page_.get()) = 1;
      break;
  }
}

}  // namespace greenloop
