#pragma once

#include <cstdint>

namespace greenloop {

/// Faults put into the link from the loop to the device, counted in cycles of virtual time.
struct InjectedFaults {
  std::int64_t delay_from = 0;    ///< first cycle whose command is held back
  std::int64_t delay_cycles = 0;  ///< that many cycles long the link holds everything back; 0: never
  std::int64_t loss_every = 0;    ///< the link loses every so-manieth command; 0: none
};

/// What a device knows about its link to the loop, counted on its side.
struct LinkSummary {
  std::int64_t cycles = 0;         ///< commands received in order
  std::int64_t late = 0;           ///< of these, not there by the end of their cycle
  std::int64_t late_injected = 0;  ///< late because the injected faults said so
  std::int64_t retransmits = 0;    ///< states sent again because no answer came
  std::int64_t digest = 0;         ///< of the last command received
  bool stopped = false;            ///< too many late commands in a row
};

/// When commands arrive in virtual time and what the device does then (the rule of libfranka): a command that is not
/// there by the end of its cycle is late; it is dropped, the last one is held, and after too many in a row all stops.
class CommandArrival {
 public:
  static constexpr std::int64_t most_in_a_row = 20;

  explicit CommandArrival(const InjectedFaults& faults = {}) : faults_(faults) {}

  /// Whether the command of `cycle` is late. Its computation takes work / budget of a cycle; counts it.
  [[nodiscard]] bool late(std::int64_t cycle, std::int64_t work, std::int64_t budget) {
    const bool is_late = work > budget || injected(cycle);
    in_a_row_ = is_late ? in_a_row_ + 1 : 0;
    late_count_ += is_late;
    return is_late;
  }

  /// Whether the fault of the link alone makes the command of `cycle` late.
  [[nodiscard]] bool injected(std::int64_t cycle) const { return held_back(cycle) || lost(cycle); }

  [[nodiscard]] bool must_stop() const { return in_a_row_ >= most_in_a_row; }
  [[nodiscard]] std::int64_t late_count() const { return late_count_; }

 private:
  [[nodiscard]] bool held_back(std::int64_t cycle) const {
    return cycle >= faults_.delay_from && cycle < faults_.delay_from + faults_.delay_cycles;
  }
  [[nodiscard]] bool lost(std::int64_t cycle) const {
    return faults_.loss_every > 0 && (cycle + 1) % faults_.loss_every == 0;
  }

  InjectedFaults faults_;
  std::int64_t in_a_row_ = 0;
  std::int64_t late_count_ = 0;
};

}  // namespace greenloop
