#pragma once

#include <cstdint>

namespace greenloop {

/// What is known of a node of a body, or of a mask (James & Pai 2003, section 3; 2001, section 6).
struct Constraint {
  enum class Kind : std::uint32_t {
    hold,     ///< all three components of a node's displacement
    normal,   ///< what a directed mask measures, as a node's displacement along its normal; all else slides freely
    force,    ///< the force on a node
    pattern,  ///< the force of a mask as a whole; it is spread by the mask's weights
    mask,     ///< all three components of a mask's mean displacement
    along,    ///< the force along a directed mask
  };

  std::uint32_t node = 0;  ///< file index of a touchable node, or the number of a mask or directed mask
  float value[3] = {};     ///< m where displacements are known, N where forces are; of a directed mask the first alone
  Kind kind = Kind::hold;  ///< Elastostatic knows forces by Limits::max_forces, `normal` and `mask` by mixed_contacts
};

/// A rigid surface at a point of a body: it may push the point and rub against it, but not pull it (Signorini's and
/// Coulomb's laws). The point is a node, or within a triangle.
struct UnilateralContact {
  static constexpr std::uint32_t none = 0xffffffff;

  std::uint32_t node[3] = {none, none, none};  ///< file indices of touchable nodes; none: there are fewer
  float weight[3] = {1, 0, 0};                 ///< of each, above 0; 1 in all, or less where a corner cannot move
  float value[3] = {};     ///< m, the point's displacement at which it touches the surface and has not slid along it
  float normal[3] = {};    ///< unit vector out of the surface, to where the point may be
  float friction = 0;      ///< Coulomb's coefficient, 0 or more; above 1,000 as 1,000
  float softness = 0;      ///< m/N, of the surface itself, 0 or more; above 0 if no node is named
  float force[3] = {};     ///< N, a guess to begin with, as from the last step
  std::uint32_t tool = 0;  ///< whose the surface is: contacts of a tool share its mount
  float mount = 0;  ///< m/N, of a spring that the whole tool hangs on, 0 or more; the same for all of its contacts
};

/// What a unilateral contact does.
enum class ContactState : std::uint8_t {
  open,   ///< no force
  stick,  ///< it does not slide
  slip,   ///< it slides, or is about to: the force is on the cone of friction
};

}  // namespace greenloop
