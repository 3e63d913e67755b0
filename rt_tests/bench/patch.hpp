#pragma once

#include <cstdint>
#include <vector>

#include "rt_tests/bench/contact_sets.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/testing/placed_body.hpp"

namespace greenloop::bench {

/// A patch of contacts resolved on the finest level of a body, the coefficients that it reaches touched.
struct Patch {
  static constexpr std::uint64_t seed = 20030102;

  Patch(const Model& model, std::size_t contacts)
      : set(patch_contacts(model.view(), 1, contacts, seed).front()),
        placed(model.view(), static_cast<std::uint32_t>(set.size())),
        body(*placed.body),
        level(model.level_count() - 1) {
    resolve_contacts(set, model.view(), body.facts, {level}, body.resolution, body.planned);
    touch(body.refinement, body.planned.column, body.planned.columns, body.touched);
  }
  [[nodiscard]] std::uint32_t order() const { return 3 * body.planned.columns; }
  [[nodiscard]] std::uint32_t stride() const { return body.cache.stride(); }

  /// The lower triangle of the capacitance matrix.
  void assemble(std::vector<Float4>& matrix) {
    assemble_capacitance(body.refinement, {body.planned.columns, body.planned.column}, body.touched, body.capacitance,
                         body.force, stride(), matrix.data());
  }

  std::vector<Constraint> set;
  PlacedBody placed;
  Body& body;
  std::uint32_t level;
};

}  // namespace greenloop::bench
