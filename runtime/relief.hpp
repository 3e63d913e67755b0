#pragma once

#include <cstdint>
#include <span>

#include "runtime/contact_body.hpp"
#include "runtime/finer_surface.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

// Fine relief of a body's surface that tools feel as friction, though no triangle has it: a normal map over the
// vertices of a finer surface modulates the coefficient of friction (force shading: Morgenbesser & Srinivasan 1996;
// James & Pai 2003, section 9.3). Friction only takes energy, whatever the map.

/// Slopes steeper than this are brought down to it, m/m.
inline constexpr float most_slope = 8;

/// What a normal map says of the relief: the gradient of its height along the surface, m/m. normal: unit, of the smooth
/// surface at rest (FinerSurface::normals); detail: the map's, of any length, in the frame of the model; slope: 0 where
/// one of them is 0 or not finite, or the map's looks into the body. False, and nothing written, unless all are of one
/// size. Work: 40 operations a vertex.
bool relief_slopes(std::span<const Vec4> normal, std::span<const Vec3> detail, std::span<Vec3> slope) noexcept;

/// The slope at the point of a triangle of the finer surface's own surface, linear between the vertices of its last
/// level. slope: [vertex_count(added())]; 0 on another size, or without such a triangle. weight: of the corners, in
/// 0..1 with sum 1. For the loop; work: 30 operations a level.
[[nodiscard]] Vec3 relief_slope(const FinerSurface& surface, std::span<const Vec3> slope, std::uint32_t triangle,
                                const float (&weight)[3]) noexcept;

/// The coefficient of friction of a tool in the next step (ContactBody::ToolInput::friction), of one that moves by
/// `way` (m a step) over the relief and touches it in these contacts, those of its last answer: that of a rigid point
/// on a slope, friction + slope along its way, not below 0, the mean of the contacts by their normal forces. Uphill it
/// is larger, downhill smaller, and without a motion, or a contact, `friction` itself: motions of less than a
/// micrometre a step count less and less. Slopes are those at rest. slope: [surface.vertex_count(added())]; `friction`
/// on another size. For the loop; work: 60 operations a contact, and for each that lies in a triangle a search of the
/// nearest point (Surface::nearest_point).
[[nodiscard]] double relief_friction(const FinerSurface& surface, std::span<const Vec3> slope, double friction,
                                     const Double3& way, std::span<const ContactBody::Contact> contacts) noexcept;

}  // namespace greenloop
