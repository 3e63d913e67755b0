#pragma once

#include <span>

namespace greenloop {

// The stiffness of point-like contact (James & Pai 2001, sections 6.2 to 6.4), N/m, 3x3 by columns: 3 c + r, force r
// per displacement c. For the loop; constant work.

/// K_i of equation 32, the inverse of a masked node's compliance (m/N, Elastostatic::masked_compliance). False, and
/// nothing is written, if that has none or it is not finite.
bool invert_compliance(std::span<const float, 9> compliance, std::span<float, 9> stiffness) noexcept;

/// K_R of section 6.2.2, of a node that is held in place: the same along all axes.
void write_rigid_stiffness(float along, std::span<float, 9> stiffness) noexcept;

/// The Frobenius norm.
[[nodiscard]] float stiffness_norm(std::span<const float, 9> stiffness) noexcept;

/// K_i becomes the haptic eta_i K_i of section 6.4, eta_i = min(1, ||K_R|| / ||K_i||), with K_R as above.
void cap_stiffness(float rigid, std::span<float, 9> stiffness) noexcept;

}  // namespace greenloop
