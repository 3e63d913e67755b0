#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sim_hw/control_loop/run_log.hpp"
#include "sim_hw/device/haptic_device.hpp"
#include "sim_hw/device/script.hpp"
#include "sim_hw/session/link.hpp"

namespace greenloop {

/// How the loop is kept from making energy: docs/device_loop.md, "Passivity".
enum class Passive { none, tank, coupling };

inline constexpr std::string_view passive_names[] = {"none", "tank", "coupling"};

inline constexpr double least_rate = 100, most_rate = 1e5;  // Hz; the hand's integration needs 100

struct SessionOptions {
  std::filesystem::path model;
  std::filesystem::path motions;  ///< of the same surface: the body vibrates; empty: it does not
  double seconds = 10;            ///< s of virtual time, > 0
  std::optional<double> rate;     ///< Hz, least_rate or more; else the model's
  std::optional<double> share;  ///< of a period that a cycle's processor time may take, above 0 and at most 1; else the
                                ///< model's
  Script script = Script::all;
  std::uint32_t tools = 2;   ///< 1..max_tools, at most so many hands
  double friction = 0.3;     ///< Coulomb's coefficient of the tools, 0 or more
  std::uint64_t budget = 0;  ///< units per cycle; 0: the model's own, or else the worst case of its finest level
  double starve = 1;         ///< (0, 1], of the budget
  Passive passive = Passive::none;
  Holder hand = Holder::person;
  double gain = 1;                  ///< > 0, of the force on the handles
  std::int64_t delay = 0;           ///< 0..1000 cycles, from a state to the rendering of its command
  std::optional<double> fast_rate;  ///< Hz, a multiple of the rate: of a loop between the body's steps
  Transport transport = Transport::automatic;
  std::optional<std::int64_t> field_every;  ///< cycles, of displacements of the whole body; else the script's
  InjectedFaults faults;
  std::int64_t overrun_cycle = -1;
  bool keep_records = false;  ///< of every cycle, for a trace
};

/// A run that came to its end, well or badly.
struct SessionResult : LinkResult {
  double device_period = 0;  ///< s, of a cycle of the device, which is the loop's unless there is a fast one
  std::uint32_t tools = 0;   ///< hands that the script moves
  DeviceSummary device;
  RunLog log{0, 0};
};

/// Runs device and loop against each other in lock step. Throws std::runtime_error if the run cannot start (model,
/// limits, a budget below Requirement::least_work, no namespace for udpm) or one side vanishes.
/// With udpm the calling thread changes to a network namespace of its own; no other thread may run then.
[[nodiscard]] SessionResult run_session(const SessionOptions& options);

}  // namespace greenloop
