#include "sim_hw/transport/packets.hpp"

#include <algorithm>
#include <iterator>

namespace greenloop {
namespace {

bool fits(std::int32_t count, std::uint32_t most) { return count >= 0 && static_cast<std::uint32_t>(count) <= most; }

}  // namespace

messages::device_state to_packet(const DeviceState& state) {
  messages::device_state packet{};
  packet.cycle = state.cycle;
  packet.resolution = state.resolution;
  std::copy(std::begin(state.origin), std::end(state.origin), packet.origin);
  std::copy(std::begin(state.gravity), std::end(state.gravity), packet.gravity);
  packet.impulse = state.impulse;
  packet.num_tools = static_cast<std::int32_t>(state.num_tools);
  packet.tools.resize(state.num_tools);
  for (std::uint32_t t = 0; t < state.num_tools; ++t) {
    std::copy_n(state.tools[t].position, 3, packet.tools[t].position);
    std::copy_n(state.tools[t].orientation, 4, packet.tools[t].orientation);
  }
  return packet;
}

messages::loop_command to_packet(const LoopCommand& command) {
  messages::loop_command packet{};
  packet.cycle = command.cycle;
  packet.work = command.work;
  packet.budget = command.budget;
  packet.level = command.level;
  packet.field_level = command.field_level;
  packet.status = command.status;
  packet.stored = command.stored;
  packet.digest = command.digest;
  packet.num_tools = static_cast<std::int32_t>(command.num_tools);
  packet.tools.resize(command.num_tools);
  for (std::uint32_t t = 0; t < command.num_tools; ++t) {
    std::copy_n(command.tools[t].force, 3, packet.tools[t].force);
    std::copy_n(command.tools[t].torque, 3, packet.tools[t].torque);
  }
  packet.num_contacts = static_cast<std::int32_t>(command.num_contacts);
  packet.contacts.resize(command.num_contacts);
  for (std::uint32_t i = 0; i < command.num_contacts; ++i) {
    packet.contacts[i].node = static_cast<std::int32_t>(command.contacts[i].node);
    packet.contacts[i].tool = command.contacts[i].tool;
    packet.contacts[i].state = command.contacts[i].state;
    std::copy_n(command.contacts[i].force, 3, packet.contacts[i].force);
  }
  return packet;
}

std::optional<DeviceState> from_packet(const messages::device_state& packet) {
  if (!fits(packet.num_tools, max_tools)) return std::nullopt;
  DeviceState state{.cycle = packet.cycle, .resolution = packet.resolution};
  std::copy(std::begin(packet.origin), std::end(packet.origin), state.origin);
  std::copy(std::begin(packet.gravity), std::end(packet.gravity), state.gravity);
  state.impulse = packet.impulse;
  state.num_tools = static_cast<std::uint32_t>(packet.num_tools);
  for (std::uint32_t t = 0; t < state.num_tools; ++t) {
    std::copy_n(packet.tools[t].position, 3, state.tools[t].position);
    std::copy_n(packet.tools[t].orientation, 4, state.tools[t].orientation);
  }
  return state;
}

std::optional<LoopCommand> from_packet(const messages::loop_command& packet) {
  if (!fits(packet.num_tools, max_tools) || !fits(packet.num_contacts, LoopCommand::max_contacts)) return std::nullopt;
  LoopCommand command{.cycle = packet.cycle,
                      .work = packet.work,
                      .budget = packet.budget,
                      .level = packet.level,
                      .field_level = packet.field_level,
                      .status = packet.status,
                      .stored = packet.stored,
                      .digest = packet.digest};
  command.num_tools = static_cast<std::uint32_t>(packet.num_tools);
  for (std::uint32_t t = 0; t < command.num_tools; ++t) {
    std::copy_n(packet.tools[t].force, 3, command.tools[t].force);
    std::copy_n(packet.tools[t].torque, 3, command.tools[t].torque);
  }
  command.num_contacts = static_cast<std::uint32_t>(packet.num_contacts);
  for (std::uint32_t i = 0; i < command.num_contacts; ++i) {
    command.contacts[i].node = static_cast<std::uint32_t>(packet.contacts[i].node);
    command.contacts[i].tool = packet.contacts[i].tool;
    command.contacts[i].state = packet.contacts[i].state;
    std::copy_n(packet.contacts[i].force, 3, command.contacts[i].force);
  }
  return command;
}

messages::impulse_state to_packet(const ImpulseState& state) {
  messages::impulse_state packet{};
  packet.cycle = state.cycle;
  packet.impulse = state.impulse;
  return packet;
}

messages::motion_command to_packet(const MotionCommand& command) {
  messages::motion_command packet{};
  packet.cycle = command.cycle;
  packet.work = command.work;
  packet.budget = command.budget;
  packet.status = command.status;
  packet.orbit = command.orbit;
  packet.row = command.row;
  packet.rank = command.rank;
  packet.digest = command.digest;
  packet.num_modes = static_cast<std::int32_t>(command.num_modes);
  packet.coordinate.assign(command.coordinate, command.coordinate + command.num_modes);
  return packet;
}

messages::drag_state to_packet(const DragState& state) {
  messages::drag_state packet{};
  packet.cycle = state.cycle;
  packet.vertex = state.vertex;
  std::copy(std::begin(state.travel), std::end(state.travel), packet.travel);
  return packet;
}

messages::drag_command to_packet(const DragCommand& command) {
  messages::drag_command packet{};
  packet.cycle = command.cycle;
  packet.work = command.work;
  packet.budget = command.budget;
  packet.status = command.status;
  packet.cycles = command.cycles;
  packet.residual = command.residual;
  std::copy(std::begin(command.force), std::end(command.force), packet.force);
  packet.digest = command.digest;
  return packet;
}

std::optional<ImpulseState> from_packet(const messages::impulse_state& packet) {
  return ImpulseState{packet.cycle, packet.impulse};
}

std::optional<MotionCommand> from_packet(const messages::motion_command& packet) {
  if (!fits(packet.num_modes, layout::most_modes)) return std::nullopt;
  MotionCommand command{.cycle = packet.cycle,
                        .work = packet.work,
                        .budget = packet.budget,
                        .status = packet.status,
                        .orbit = packet.orbit,
                        .row = packet.row,
                        .rank = packet.rank,
                        .digest = packet.digest,
                        .num_modes = static_cast<std::uint32_t>(packet.num_modes)};
  std::copy(packet.coordinate.begin(), packet.coordinate.end(), command.coordinate);
  return command;
}

std::optional<DragState> from_packet(const messages::drag_state& packet) {
  return DragState{packet.cycle, packet.vertex, {packet.travel[0], packet.travel[1], packet.travel[2]}};
}

std::optional<DragCommand> from_packet(const messages::drag_command& packet) {
  return DragCommand{.cycle = packet.cycle,
                     .work = packet.work,
                     .budget = packet.budget,
                     .status = packet.status,
                     .cycles = packet.cycles,
                     .residual = packet.residual,
                     .force = {packet.force[0], packet.force[1], packet.force[2]},
                     .digest = packet.digest};
}

}  // namespace greenloop
