#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>

#include "rt_tests/harness/minor_faults.hpp"
#include "sim_hw/guard/guarded.hpp"

namespace greenloop {

/// A fault put into every hundredth step of a script, to show that the verdict can fail.
enum class InjectedFault : std::uint8_t { none, allocation, lock, system_call, page_fault, overrun };

/// Steps, or calls in them, that break what the runtime declares.
struct Violations {
  std::uint64_t work_overruns = 0;  ///< work above the budget or the declared bound
  std::uint64_t wrong_answers = 0;  ///< refused what is right, answered what is wrong, not finite, or held ones written
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;
  std::uint64_t system_calls = 0;  ///< steps with any
  std::uint64_t minor_faults = 0;

  [[nodiscard]] std::uint64_t sum() const {
    return work_overruns + wrong_answers + allocations + locks + system_calls + minor_faults;
  }
};

/// As reports call them.
struct NamedCount {
  const char* name;
  std::uint64_t count;
};
[[nodiscard]] std::array<NamedCount, 6> named(const Violations& violations);

/// "HELD", or "VIOLATED: work_overruns 3, locks 1".
[[nodiscard]] std::string verdict_of(const Violations& violations);

/// Runs steps with all guards armed, and puts faults into them.
class GuardedSteps {
 public:
  static constexpr std::uint64_t fault_interval = 100;  ///< steps

  explicit GuardedSteps(InjectedFault fault) : fault_(fault) {}

  /// Before the first step: installs what watches system calls. False: this kernel cannot tell.
  [[nodiscard]] bool prepare();

  /// Runs a step, with the fault in it if it is to be faulty, and counts what it did that it must not. overrun: makes
  /// its report say too much.
  template <class Step, class Overrun>
  void run(Step step, Overrun overrun, bool is_faulty, Violations& violations) {
    prepare_fault(is_faulty);
    const std::uint64_t faults = minor_faults();
    const GuardCounts seen = guarded([&] {
      step();
      if (is_faulty && fault_ == InjectedFault::overrun) overrun();
      if (is_faulty) commit_fault();
    });
    violations.minor_faults += minor_faults() - faults;
    violations.allocations += seen.allocations;
    violations.locks += seen.locks;
    violations.system_calls += seen.system_calls;
  }

 private:
  void prepare_fault(bool is_faulty);
  void commit_fault();

  InjectedFault fault_;
  std::unique_ptr<int> leak_;
  std::mutex mutex_;
  std::unique_ptr<char, decltype(&std::free)> page_{nullptr, &std::free};
};

}  // namespace greenloop
