#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/friction/contact_problem.hpp"
#include "runtime/model.hpp"

namespace greenloop::bench {

/// A patch of candidates with its compliance, and gaps of a sphere that is pressed on it and then dragged: steps in
/// which only the gaps differ, before the slips of the steps before are taken off.
struct ContactSequence {
  std::vector<Block<3>> compliance;
  std::vector<std::vector<ContactCandidate>> steps;
};

/// So many touchable nodes around a random one of a model's finest level.
[[nodiscard]] ContactSequence pressed_and_dragged(const Model& model, std::size_t contacts, float friction,
                                                  std::uint64_t seed);

/// What the other solver took to the residual that ours was asked for.
struct SiconosFigures {
  double us = 0;  ///< median of a warm step, of the faster of its solvers
  std::string solver;
  std::size_t failed = 0;  ///< steps that neither of them solved
};

/// A count of frictional contacts, by thread CPU time without that of reading the clock, beside Siconos Numerics, in
/// double precision, on the same problems, from the same start and to the same residual.
struct ContactFigures {
  std::size_t contacts = 0;
  float friction = 0;
  float residual = 0;                     ///< largest, relative natural map
  double us = 0;                          ///< median of the steps, each from the answer of the one before
  double worst_us = 0;                    ///< of them
  double cold_us = 0;                     ///< median from no force at all
  std::uint64_t work = 0;                 ///< units, median
  std::size_t unfinished = 0;             ///< steps whose residual stayed above what was asked for
  std::optional<SiconosFigures> siconos;  ///< where it is installed
};

/// Over several patches.
[[nodiscard]] ContactFigures measure_contacts(const Model& model, std::size_t contacts, float friction,
                                              std::size_t patches);

}  // namespace greenloop::bench
