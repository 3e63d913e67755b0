#pragma once

#include <cstdint>

namespace greenloop {

/// What is known of a node of a body, or of a pattern of forces on it (James & Pai 2003, section 3).
struct Constraint {
  enum class Kind : std::uint32_t {
    hold,     ///< all three components of its displacement
    normal,   ///< its displacement along the normal; it slides freely across it
    force,    ///< the force on it
    pattern,  ///< the force of a mask, by its number, as a whole; it is spread by the mask's weights
  };

  std::uint32_t node = 0;  ///< file index of a touchable node; of a pattern the number of its mask
  float value[3] = {};     ///< m where displacements are known, N where forces are
  Kind kind = Kind::hold;  ///< Elastostatic refuses `normal`, and knows forces by Limits::max_forces
};

/// A rigid surface at a node: it may push the node and rub against it, but not pull it (Signorini's and Coulomb's laws).
struct UnilateralContact {
  std::uint32_t node = 0;  ///< file index of a touchable node
  float value[3] = {};     ///< m, the displacement at which the node touches the surface and has not slid along it
  float normal[3] = {};    ///< unit vector out of the surface, to where the node may be
  float friction = 0;      ///< Coulomb's coefficient, 0 or more
};

/// What a unilateral contact does.
enum class ContactState : std::uint8_t {
  open,   ///< no force
  stick,  ///< it does not slide
  slip,   ///< it slides, or is about to: the force is on the cone of friction
};

}  // namespace greenloop
