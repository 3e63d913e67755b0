#pragma once

#include <cstdint>
#include <span>

#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/loads.hpp"

namespace greenloop {

/// What comes of checking a step's constraints and loads, the units that took, and the contacts among them.
struct Accepted {
  CheckedContacts checked;
  std::uint64_t work = 0;
  Contacts contacts;
};

/// The finest level of the nodes that the response has room for; none if that is no level.
[[nodiscard]] std::uint32_t finest_displaced(const Body& body, const Elastostatic::Response& response) noexcept;

/// Whether budget, number of constraints and buffers will do.
[[nodiscard]] Status check_request(const Body& body, std::size_t constraints, Budget budget,
                                   const Elastostatic::Response& response) noexcept;

// What follows takes checked requests. Apart, so that it does not stand on the stack of an answer. For the loop; work:
// Accepted::work.

/// Contacts alone.
void accept_contacts(Body& body, std::span<const Constraint> contacts, std::span<Vec3> force,
                     Accepted& accepted) noexcept;

/// And whatever else acts.
void accept_loaded(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads& loads,
                   std::span<Vec3> force, Accepted& accepted) noexcept;

/// The same of unilateral contacts, whose nodes are the contacts. found: what will be found of them.
void accept_surfaces(Body& body, std::span<const UnilateralContact> surfaces, const Elastostatic::Loads& loads,
                     const Elastostatic::UnilateralResponse& response, ContactAnswer& found,
                     Accepted& accepted) noexcept;

}  // namespace greenloop
