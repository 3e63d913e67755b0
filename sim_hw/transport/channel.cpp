#include "sim_hw/transport/channel.hpp"

#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim_hw/transport/packets.hpp"

namespace greenloop {
namespace {

constexpr const char* state_name = "DEVICE_STATE";
constexpr const char* command_name = "LOOP_COMMAND";
constexpr const char* impulse_name = "IMPULSE_STATE";
constexpr const char* motion_name = "MOTION_COMMAND";
constexpr const char* drag_name = "DRAG_STATE";
constexpr const char* dragged_name = "DRAG_COMMAND";

template <typename Packet>
void publish(lcm_t* lcm, const char* name, const Packet& packet) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(packet.getEncodedSize()));
  const int length = packet.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  if (length < 0 || lcm_publish(lcm, name, bytes.data(), static_cast<unsigned>(length)) != 0) {
    throw std::runtime_error(std::string("lcm: ") + name + " cannot be sent");
  }
}

/// The packet in the bytes, if it is one. LCM's decoder throws where an array's length is absurd.
template <typename Packet>
bool decode(const lcm_recv_buf_t& buffer, Packet& packet) {
  try {
    return packet.decode(buffer.data, 0, static_cast<int>(buffer.data_size)) >= 0;
  } catch (const std::exception&) {
    return false;
  }
}

/// `receiver` is the std::function that takes the value. What cannot be decoded is not ours and is ignored.
template <typename Packet, typename Value>
void deliver(const lcm_recv_buf_t* buffer, const char*, void* receiver) {
  Packet packet;
  if (!decode(*buffer, packet)) return;
  if (const auto value = from_packet(packet)) (*static_cast<std::function<void(const Value&)>*>(receiver))(*value);
}

}  // namespace

Channel::Channel(const char* url) : lcm_(lcm_create(url)) {
  if (!lcm_) throw std::runtime_error(std::string("lcm: ") + url + " cannot be opened; is there a multicast route?");
}

void Channel::on_state(std::function<void(const DeviceState&)> receive) {
  receive_state_ = std::move(receive);
  lcm_subscribe(lcm_.get(), state_name, deliver<messages::device_state, DeviceState>, &receive_state_);
}

void Channel::on_command(std::function<void(const LoopCommand&)> receive) {
  receive_command_ = std::move(receive);
  lcm_subscribe(lcm_.get(), command_name, deliver<messages::loop_command, LoopCommand>, &receive_command_);
}

void Channel::on_state(std::function<void(const ImpulseState&)> receive) {
  receive_impulse_ = std::move(receive);
  lcm_subscribe(lcm_.get(), impulse_name, deliver<messages::impulse_state, ImpulseState>, &receive_impulse_);
}

void Channel::on_command(std::function<void(const MotionCommand&)> receive) {
  receive_motion_ = std::move(receive);
  lcm_subscribe(lcm_.get(), motion_name, deliver<messages::motion_command, MotionCommand>, &receive_motion_);
}

void Channel::on_state(std::function<void(const DragState&)> receive) {
  receive_drag_ = std::move(receive);
  lcm_subscribe(lcm_.get(), drag_name, deliver<messages::drag_state, DragState>, &receive_drag_);
}

void Channel::on_command(std::function<void(const DragCommand&)> receive) {
  receive_dragged_ = std::move(receive);
  lcm_subscribe(lcm_.get(), dragged_name, deliver<messages::drag_command, DragCommand>, &receive_dragged_);
}

void Channel::send(const DeviceState& state) { publish(lcm_.get(), state_name, to_packet(state)); }
void Channel::send(const LoopCommand& command) { publish(lcm_.get(), command_name, to_packet(command)); }
void Channel::send(const ImpulseState& state) { publish(lcm_.get(), impulse_name, to_packet(state)); }
void Channel::send(const MotionCommand& command) { publish(lcm_.get(), motion_name, to_packet(command)); }
void Channel::send(const DragState& state) { publish(lcm_.get(), drag_name, to_packet(state)); }
void Channel::send(const DragCommand& command) { publish(lcm_.get(), dragged_name, to_packet(command)); }

bool Channel::receive(int milliseconds) {
  errno = 0;
  const int handled = lcm_handle_timeout(lcm_.get(), milliseconds);
  if (handled < 0 && errno == EINTR) return false;
  if (handled < 0) throw std::runtime_error("lcm: receiving failed");
  return handled > 0;
}

}  // namespace greenloop
