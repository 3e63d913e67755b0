#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace greenloop::gel_pad {

/// m, along x and along y, each increasing, two or more.
using SidePlanes = std::array<std::vector<double>, 2>;

/// A quantity on the upper side of a pad: at the crossings of planes, linear in the triangles between them, each cell's
/// diagonal along (1, 1), and 0 beyond.
struct SideField {
  SidePlanes planes;
  Eigen::VectorXd value;    ///< at crossing (i, j): entry i + j planes[0].size()
  bool is_quarter = false;  ///< the planes begin at 0, and the other three quarters mirror this one

  [[nodiscard]] double at(double x, double y) const;
};

/// The integrals of the functions that are 1 at one crossing and 0 at the others, m^2: forces that are spread by these
/// functions are integrals over the pressure that has force over area at each crossing.
[[nodiscard]] Eigen::VectorXd crossing_areas(const SidePlanes& planes);

/// A tool's force on the pad and the pressure along the pad's normal.
struct Pressed {
  double force = 0;    ///< N, along the normal
  SideField pressure;  ///< Pa
};

/// How far an answer is from another.
struct Difference {
  double force = 0;     ///< relative
  double pressure = 0;  ///< RMS over the upper side, over the RMS of the other
};

/// Pressures are compared at points that lie far denser than the crossings of either.
[[nodiscard]] Difference difference(const Pressed& found, const Pressed& expected);

}  // namespace greenloop::gel_pad
