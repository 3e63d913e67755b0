#pragma once

#include <cstdint>

namespace greenloop {

/// What is known of a node of a body, or of a pattern of forces on it (James & Pai 2003, section 3).
struct Constraint {
  enum class Kind : std::uint32_t {
    hold,     ///< all three components of its displacement
    normal,   ///< its displacement along the normal; it slides freely across it
    force,    ///< the force on it
    pattern,  ///< a pattern of forces, by its number, as a whole
  };

  std::uint32_t node = 0;  ///< file index of a touchable node; of a pattern its number
  float value[3] = {};     ///< m where displacements are known, N where forces are
  Kind kind = Kind::hold;  ///< Elastostatic knows `hold` and refuses the others
};

}  // namespace greenloop
