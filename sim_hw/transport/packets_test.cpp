#include "sim_hw/transport/packets.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace greenloop {
namespace {

/// The packet after it went through bytes as LCM sends them.
template <typename Packet>
Packet sent(const Packet& packet) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(packet.getEncodedSize()));
  const auto length = static_cast<int>(bytes.size());
  REQUIRE(packet.encode(bytes.data(), 0, length) == length);
  Packet received;
  REQUIRE(received.decode(bytes.data(), 0, length) == length);
  return received;
}

DeviceState state_of(std::uint32_t tools) {
  DeviceState state{
      .cycle = 77, .resolution = 1e-5, .origin = {1, -2, 3}, .gravity = {0.5, 0, -9.81}, .num_tools = tools};
  for (std::uint32_t t = 0; t < tools; ++t) {
    const auto number = static_cast<std::int16_t>(t);
    state.tools[t] = {{100 + number, -number, INT32_MAX}, {ToolState::unit, number, INT16_MIN, 3}};
  }
  state.impulse = 3;
  return state;
}

TEST_CASE("a state of any number of tools arrives as it was sent") {
  for (std::uint32_t tools = 0; tools <= max_tools; ++tools) {
    const DeviceState state = state_of(tools);
    const auto arrived = from_packet(sent(to_packet(state)));
    REQUIRE(arrived);
    CHECK(arrived->cycle == 77);
    CHECK(arrived->resolution == 1e-5);
    CHECK(arrived->impulse == 3);
    CHECK(std::equal(std::begin(state.origin), std::end(state.origin), arrived->origin));
    CHECK(std::equal(std::begin(state.gravity), std::end(state.gravity), arrived->gravity));
    REQUIRE(arrived->num_tools == tools);
    for (std::uint32_t t = 0; t < tools; ++t) {
      CHECK(std::equal(state.tools[t].position, state.tools[t].position + 3, arrived->tools[t].position));
      CHECK(std::equal(state.tools[t].orientation, state.tools[t].orientation + 4, arrived->tools[t].orientation));
    }
  }
}

TEST_CASE("a command of any number of tools and contacts arrives as it was sent") {
  for (const std::uint32_t contacts : {0U, 1U, LoopCommand::max_contacts}) {
    LoopCommand command{
        .cycle = 5, .work = 6, .budget = 7, .level = 3, .field_level = 2, .status = 1, .digest = -8, .num_tools = 3};
    command.tools[2].force[1] = -0.25;
    command.tools[1].torque[2] = 0.5;
    command.num_contacts = contacts;
    for (std::uint32_t i = 0; i < contacts; ++i)
      command.contacts[i] = {1000 + i, 2, 1, {0.5F, static_cast<float>(i), -1}};
    const auto arrived = from_packet(sent(to_packet(command)));
    REQUIRE(arrived);
    CHECK(arrived->cycle == 5);
    CHECK(arrived->work == 6);
    CHECK(arrived->budget == 7);
    CHECK(arrived->level == 3);
    CHECK(arrived->field_level == 2);
    CHECK(arrived->status == 1);
    CHECK(arrived->digest == -8);
    CHECK(arrived->num_tools == 3);
    CHECK(arrived->tools[2].force[1] == -0.25);
    REQUIRE(arrived->num_contacts == contacts);
    for (std::uint32_t i = 0; i < contacts; ++i) {
      CHECK(arrived->contacts[i].node == 1000 + i);
      CHECK(arrived->contacts[i].force[1] == static_cast<float>(i));
    }
  }
}

TEST_CASE("a packet of more tools or contacts than there is room for is refused") {
  messages::device_state state = to_packet(state_of(max_tools));
  ++state.num_tools;
  state.tools.emplace_back();
  CHECK_FALSE(from_packet(state));
  state.num_tools = -1;
  CHECK_FALSE(from_packet(state));
  LoopCommand whole{};
  whole.num_contacts = LoopCommand::max_contacts;
  messages::loop_command command = to_packet(whole);
  CHECK(from_packet(command));
  ++command.num_contacts;
  command.contacts.emplace_back();
  CHECK_FALSE(from_packet(command));
}

TEST_CASE("impulses and motions travel as they are, and too many modes are none") {
  const auto state = from_packet(to_packet(ImpulseState{7, -1}));
  REQUIRE(state);
  CHECK(state->cycle == 7);
  CHECK(state->impulse == -1);
  MotionCommand sent{.cycle = 8, .work = 9, .budget = 10, .status = 1, .orbit = 2, .row = 3, .rank = 4, .digest = -5};
  sent.num_modes = layout::most_modes;
  for (std::uint32_t m = 0; m < sent.num_modes; ++m) sent.coordinate[m] = static_cast<float>(m) / 3;
  messages::motion_command packet = to_packet(sent);
  const auto command = from_packet(packet);
  REQUIRE(command);
  CHECK(command->cycle == 8);
  CHECK(command->work == 9);
  CHECK(command->budget == 10);
  CHECK(command->status == 1);
  CHECK(command->orbit == 2);
  CHECK(command->row == 3);
  CHECK(command->rank == 4);
  CHECK(command->digest == -5);
  CHECK(std::equal(sent.coordinate, sent.coordinate + layout::most_modes, command->coordinate));
  packet.num_modes = layout::most_modes + 1;
  CHECK(!from_packet(packet));
  packet.num_modes = -1;
  CHECK(!from_packet(packet));
}

}  // namespace
}  // namespace greenloop
