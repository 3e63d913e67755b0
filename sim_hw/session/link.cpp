#include "sim_hw/session/link.hpp"

#include <stdexcept>

#include "sim_hw/transport/network_namespace.hpp"

namespace greenloop {

void choose_transport(Transport transport, LinkResult& result) {
  result.transport = "memq";
  result.processes = 1;
  if (transport == Transport::memq) {
    result.transport_reason = "asked for";
    return;
  }
  const NamespaceEntry entry = enter_loopback_namespace();
  if (entry.entered) {
    result.transport = "udpm";
    result.processes = 2;
  } else if (transport == Transport::udpm) {
    throw std::runtime_error("--transport udpm: " + entry.reason + "; use auto or memq");
  } else {
    result.transport_reason = entry.reason;
  }
}

}  // namespace greenloop
