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

}  // namespace greenloop
