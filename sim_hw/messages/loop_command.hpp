#pragma once

#include <cstdint>

#include "sim_hw/messages/device_state.hpp"

namespace greenloop {

/// What a tool does to the body at one place.
struct ContactForce {
  std::uint32_t node = 0;  ///< there, or the first corner of the triangle that the place lies in
  std::uint8_t tool = 0;
  std::uint8_t state = 0;  ///< greenloop::ContactState
  float force[3] = {};     ///< N on the body
};

/// What one tool feels.
struct ToolForce {
  double force[3] = {};   ///< N on the tool, unscaled
  double torque[3] = {};  ///< N m on the tool about its centre, unscaled
};

/// What the control loop answers to a DeviceState: loop_command.lcm with room for the most tools and contacts.
struct LoopCommand {
  static constexpr std::uint32_t max_contacts = 256;

  std::int64_t cycle = 0;        ///< of the state it answers
  std::int64_t work = 0;         ///< units spent
  std::int64_t budget = 0;       ///< units allowed
  std::int32_t level = 0;        ///< constraint level of the answer
  std::int32_t field_level = 0;  ///< finest level of detail in the field
  std::int32_t status = 0;       ///< greenloop::Status
  double stored = 0;             ///< J, what the contacts strain the body with
  std::int64_t digest = 0;       ///< FNV-1a 64 over all responses up to this one, as two's complement
  std::uint32_t num_tools = 0;   ///< 0..max_tools
  ToolForce tools[max_tools] = {};
  std::uint32_t num_contacts = 0;  ///< 0..max_contacts
  ContactForce contacts[max_contacts] = {};
};

}  // namespace greenloop
