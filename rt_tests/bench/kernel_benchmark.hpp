#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/store/green_store.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::bench {

// The parts of a step by themselves. Thread CPU time, medians of `rounds`; ratios are taken round by round.

/// The inverse transform of a field of 64 contacts against one dense Green's function.
struct TransformFigures {
  double transform_us = 0;
  double dense_column_us = 0;  ///< a node's three scalar columns, summed by sgemv into a field
  double ratio = 0;            ///< transform over dense column
};
[[nodiscard]] TransformFigures measure_transform(const Model& model, const GreenStore& store, std::size_t rounds);

/// Capacitance matrix and factors of patches of so many contacts.
struct CapacitanceFigures {
  std::size_t contacts = 0;
  double extract_ns_per_block = 0;  ///< assembling the matrix, over its 3x3 blocks on and below the diagonal
  double factor_us = 0;             ///< fresh Cholesky
  double insert_us = 0;             ///< one node by bordering, its column of the matrix given
  double remove_us = 0;             ///< one node, from a random place
  std::uint64_t updates = 0;        ///< nodes removed and inserted before drift is measured
  double drift = 0;                 ///< ||L D L^T - A||_F / ||A||_F after those
};
[[nodiscard]] CapacitanceFigures measure_capacitance(const Model& model, std::size_t contacts, std::size_t rounds,
                                                     std::uint64_t updates);

/// A step without a field whose factor is cached.
struct ForceFigures {
  std::size_t contacts = 0;
  double us = 0;
};
[[nodiscard]] ForceFigures measure_forces(const Model& model, std::size_t contacts, std::size_t rounds);

/// What a body costs to make.
struct CreationFigures {
  Elastostatic::Limits limits;
  double create_ms = 0;  ///< Elastostatic::create, once, in memory that has been touched
  std::size_t arena_bytes = 0;
};
[[nodiscard]] CreationFigures measure_creation(const Model& model, const Elastostatic::Limits& limits);

}  // namespace greenloop::bench
