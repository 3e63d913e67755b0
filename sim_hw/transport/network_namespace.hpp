#pragma once

#include <string>

namespace greenloop {

/// Whether the calling thread now lives in a network of its own.
struct NamespaceEntry {
  bool entered = false;
  std::string reason;  ///< if not: what was refused
};

/// Moves the calling thread, and all it starts from now on, into a new network namespace in which there is only a
/// loopback device that carries multicast: nothing sent from there can leave the machine. As root directly, else in a
/// user namespace of its own. Where neither is permitted, nothing has changed.
[[nodiscard]] NamespaceEntry enter_loopback_namespace();

}  // namespace greenloop
