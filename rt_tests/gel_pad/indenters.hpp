#pragma once

#include <string_view>
#include <vector>

#include "runtime/contact/tool.hpp"

namespace greenloop::gel_pad {

inline constexpr double thickness = 3e-3;  ///< m, of the pad; its upper side is the plane z = thickness

/// A rigid tool that is pressed into the pad's middle from above.
struct Indenter {
  std::string_view name;
  Shape shape;
  double quaternion[4];  ///< turns the shape's axes into the pad's
  double lowest;         ///< m, of the turned shape below its origin
  double depth;          ///< m, how far it goes in

  /// Its pose with its lowest place so deep in the undeformed pad, m; above it if negative.
  [[nodiscard]] Pose at(double deep) const;
};

/// A ball, a cylinder with round ends that lies along x, and a thin one along y, an edge of 1 mm radius, each as deep
/// as it is compared.
[[nodiscard]] std::vector<Indenter> indenters();

}  // namespace greenloop::gel_pad
