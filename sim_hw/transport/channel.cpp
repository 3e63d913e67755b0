#include "sim_hw/transport/channel.hpp"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace greenloop {
namespace {

constexpr const char* state_name = "DEVICE_STATE";
constexpr const char* command_name = "LOOP_COMMAND";

template <typename Message>
void publish(lcm_t* lcm, const char* name, const Message& message) {
  std::array<std::uint8_t, sizeof(Message) + 64> bytes;
  const int length = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  if (length < 0 || lcm_publish(lcm, name, bytes.data(), static_cast<unsigned>(length)) != 0) {
    throw std::runtime_error(std::string("lcm: ") + name + " cannot be sent");
  }
}

/// `receiver` is the std::function that takes the message. What cannot be decoded is not ours and is ignored.
template <typename Message>
void deliver(const lcm_recv_buf_t* buffer, const char*, void* receiver) {
  Message message;
  if (message.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) < 0) return;
  (*static_cast<std::function<void(const Message&)>*>(receiver))(message);
}

}  // namespace

Channel::Channel(const char* url) : lcm_(lcm_create(url)) {
  if (!lcm_) throw std::runtime_error(std::string("lcm: ") + url + " cannot be opened; is there a multicast route?");
}

void Channel::on_state(std::function<void(const messages::device_state&)> receive) {
  receive_state_ = std::move(receive);
  lcm_subscribe(lcm_.get(), state_name, deliver<messages::device_state>, &receive_state_);
}

void Channel::on_command(std::function<void(const messages::loop_command&)> receive) {
  receive_command_ = std::move(receive);
  lcm_subscribe(lcm_.get(), command_name, deliver<messages::loop_command>, &receive_command_);
}

void Channel::send(const messages::device_state& state) { publish(lcm_.get(), state_name, state); }
void Channel::send(const messages::loop_command& command) { publish(lcm_.get(), command_name, command); }

bool Channel::receive(int milliseconds) {
  const int handled = lcm_handle_timeout(lcm_.get(), milliseconds);
  if (handled < 0) throw std::runtime_error("lcm: receiving failed");
  return handled > 0;
}

}  // namespace greenloop
