#pragma once

#include <optional>

#include "greenloop/messages/device_state.hpp"
#include "greenloop/messages/drag_command.hpp"
#include "greenloop/messages/drag_state.hpp"
#include "greenloop/messages/impulse_state.hpp"
#include "greenloop/messages/loop_command.hpp"
#include "greenloop/messages/motion_command.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/drag_command.hpp"
#include "sim_hw/messages/drag_state.hpp"
#include "sim_hw/messages/impulse_state.hpp"
#include "sim_hw/messages/loop_command.hpp"
#include "sim_hw/messages/motion_command.hpp"

namespace greenloop {

// Between the messages that travel, whose arrays are as long as they need to be, and the values that threads hand over.
// Never for the loop itself: they allocate.

[[nodiscard]] messages::device_state to_packet(const DeviceState& state);
[[nodiscard]] messages::loop_command to_packet(const LoopCommand& command);
[[nodiscard]] messages::impulse_state to_packet(const ImpulseState& state);
[[nodiscard]] messages::motion_command to_packet(const MotionCommand& command);
[[nodiscard]] messages::drag_state to_packet(const DragState& state);
[[nodiscard]] messages::drag_command to_packet(const DragCommand& command);

/// None if it has more tools than max_tools, or fewer than none.
[[nodiscard]] std::optional<DeviceState> from_packet(const messages::device_state& packet);

/// The same, also with more contacts than LoopCommand::max_contacts.
[[nodiscard]] std::optional<LoopCommand> from_packet(const messages::loop_command& packet);

/// Any; what impulse it names is the loop's to judge.
[[nodiscard]] std::optional<ImpulseState> from_packet(const messages::impulse_state& packet);

/// None if it has more modes than layout::most_modes, or fewer than none.
[[nodiscard]] std::optional<MotionCommand> from_packet(const messages::motion_command& packet);

/// Any; what vertex it names is the loop's to judge.
[[nodiscard]] std::optional<DragState> from_packet(const messages::drag_state& packet);

/// Any.
[[nodiscard]] std::optional<DragCommand> from_packet(const messages::drag_command& packet);

}  // namespace greenloop
