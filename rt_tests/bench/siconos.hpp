#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "runtime/friction/contact_problem.hpp"

namespace greenloop::bench {

/// One contact problem for Siconos Numerics, in the frames of its contacts, in double precision: displacements in units
/// of what the mean contact's own compliance gives per newton, so that its natural map has the scale of ours.
class SiconosProblem {
 public:
  SiconosProblem(const ContactCompliance& compliance, const std::vector<ContactCandidate>& candidates);

  struct Answer {
    bool solved = false;
    double us = 0;  ///< thread CPU time
  };
  /// Whether it is installed.
  [[nodiscard]] static bool available();
  /// NSGS or the nonsmooth Newton solver on Alart and Curnier's function, from `force` [candidates], until the natural
  /// map is `residual` of the norm of `forces`, which is known.
  [[nodiscard]] Answer solve(bool newton, const std::vector<Vec4>& start, const std::vector<Vec4>& forces,
                             double residual);

 private:
  std::size_t count_;
  std::vector<double> matrix_;  ///< by columns
  std::vector<double> free_;
  std::vector<double> friction_;
  std::vector<double> frame_;  ///< [candidates][3][3] normal and tangents
};

}  // namespace greenloop::bench
