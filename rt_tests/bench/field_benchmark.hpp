#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/store/green_store.hpp"
#include "runtime/model.hpp"

namespace greenloop::bench {

/// One rung of the ladder a step descends as its budget shrinks.
struct Rung {
  std::uint32_t constraint_level = 0;
  std::uint32_t field_level = 0;
  std::uint64_t work = 0;  ///< units, median over the sets, factor cached
  double step_us = 0;      ///< median
  double rms_error = 0;    ///< of the field, against the exact solution at the finest level
  double force_error = 0;  ///< worst of the contact forces
};

/// A contact count measured beside what a user would write instead. Contacts move from set to set; the ratios are
/// medians over rounds, in each of which all of it is timed.
struct FieldFigures {
  std::size_t contacts = 0;
  std::size_t sets = 0;             ///< contact sets that take turns
  double dense_us = 0;              ///< summing the dense columns for given forces, single precision, OpenBLAS
  double field_us = 0;              ///< the same field by the model for the same forces, warm
  double step_us = 0;               ///< a whole step: forces by a cached factor and the field of every node, warm
  double cold_step_us = 0;          ///< the same after dense columns have filled the caches
  double fresh_step_us = 0;         ///< with a factor of its own
  double field_dense_ratio = 0;     ///< dense / field
  double dense_ratio = 0;           ///< dense / step
  double cold_dense_ratio = 0;      ///< dense / cold step
  double same_set_dense_ratio = 0;  ///< dense / step with one set over and over
  double backsolve_ratio = 0;       ///< one sparse back-substitution / step
  double rms_error = 0;             ///< ||u^ - u||_F / ||u||_F over all sets, exact forces and columns
  double force_error = 0;           ///< worst ||f^ - f|| / ||f|| of a set's contact forces
  double total_force_error = 0;     ///< worst relative error of a set's total force
  std::uint64_t work = 0;           ///< units of a step, median over the sets
  std::vector<Rung> rungs;          ///< finest first
};

/// Measures one contact count, by thread CPU time.
[[nodiscard]] FieldFigures measure_field(const Model& model, const GreenStore& store, std::size_t contacts,
                                         std::size_t rounds, double back_substitution_seconds);

}  // namespace greenloop::bench
