#include "sim_hw/transport/network_namespace.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace greenloop {
namespace {

NamespaceEntry refused(const char* what) { return {false, std::string(what) + ": " + std::strerror(errno)}; }

bool set_up_loopback(int socket) {
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK | IFF_MULTICAST;
  return ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

void set_address(sockaddr& address, const char* dotted) {
  sockaddr_in internet{};
  internet.sin_family = AF_INET;
  (void)inet_pton(AF_INET, dotted, &internet.sin_addr);
  std::memcpy(&address, &internet, sizeof(internet));
}

/// Without this route there is no device to send multicast through.
bool route_multicast_to_loopback(int socket) {
  char device[] = "lo";
  rtentry route{};
  set_address(route.rt_dst, "224.0.0.0");
  set_address(route.rt_genmask, "240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = device;
  return ioctl(socket, SIOCADDRT, &route) == 0;
}

}  // namespace

NamespaceEntry enter_loopback_namespace() {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
    return refused("a network namespace is not permitted");
  }
  const int control = socket(AF_INET, SOCK_DGRAM, 0);
  if (control < 0) return refused("no socket in the network namespace");
  NamespaceEntry entry{true, ""};
  if (!set_up_loopback(control)) {
    entry = refused("lo cannot be brought up in the network namespace");
  } else if (!route_multicast_to_loopback(control)) {
    entry = refused("multicast cannot be routed to lo in the network namespace");
  }
  (void)close(control);
  return entry;
}

}  // namespace greenloop
