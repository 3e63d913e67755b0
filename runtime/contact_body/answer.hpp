#pragma once

#include <cstdint>
#include <span>

#include "runtime/contact_body/touched_body.hpp"

namespace greenloop {

// What an answered step leaves: in this order, each once, linear in the contacts; for the loop.

/// Displacement of a point by its nodes, m; those after the last are layout::none.
[[nodiscard]] Double3 displacement_of(const TouchedBody& body, const std::uint32_t (&node)[3],
                                      const double (&weight)[3]) noexcept;

/// The tools' springs give way to what their `count` contacts push: tools, and where contacts stick to them, move
/// along.
void let_sag(TouchedBody& body, std::uint32_t count, std::span<const ContactBody::ToolInput> tools) noexcept;

/// What the contacts of this step did, and those of the last that are none now; before these are forgotten.
void account_energy(TouchedBody& body, std::uint32_t count) noexcept;

/// What a tool holds on to, and pushes, is forgotten. Linear in the contacts.
void let_go(TouchedBody& body, std::uint32_t tool) noexcept;

/// What is handed out of so many tools, and what the next step knows of this one's contacts.
void write_answer(TouchedBody& body, std::uint32_t count, std::uint32_t tools) noexcept;

}  // namespace greenloop
