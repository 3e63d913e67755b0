#pragma once

#include <cstdint>
#include <span>

#include "formats/view/multigrid.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/multigrid/cycle.hpp"
#include "runtime/multigrid/elements.hpp"
#include "runtime/multigrid/newmark.hpp"

namespace greenloop {

/// Displacement, velocity and acceleration of all vertices, fourth lanes 0.
struct ElasticState {
  std::span<Float4> displacement, velocity, acceleration;
};

/// What a body of a multigrid model keeps in its arena.
struct ElasticBody {
  MultigridView view;
  StrainMeasure measure = StrainMeasure::linear;
  Newmark newmark;
  std::span<TetrahedronGroup> groups;
  std::span<Matrix4> frame;                     ///< [groups]
  std::span<Quaternion4> quaternion;            ///< [groups], of `frame`'s rotations
  std::span<Quaternion4> last_quaternion;       ///< [groups], of the last step's state
  std::span<Float4> vertex_quaternion, turned;  ///< [free]
  ElasticState state, next;                     ///< of the last step, and of the one that is being found
  std::span<Float4> force;                      ///< [vertices] external
  std::span<float> vertex_mass;                 ///< [vertices] kg, a quarter of the tetrahedra around
  Float4 gravity{};                             ///< m/s^2, of this step
  std::span<Float4> residual, inertia;          ///< [vertices]
  std::span<Float4> rest, preconditioned, direction, image, change;  ///< [vertices] of conjugate gradients
  std::span<float> moves;                                            ///< [vertices] 0 where a vertex is held, else 1
  std::span<std::uint32_t> held;                                     ///< [max_holds] vertices that the last step held
  std::uint32_t holds = 0;
  std::uint32_t max_loads = 0, max_holds = 0;
  float tolerance = 0;
  MultigridLevel levels[layout::most_grids];
  MultigridCycle::Fields fields[layout::most_grids];
  MultigridCycle cycle;
  std::uint64_t least_work = 0;

  [[nodiscard]] std::uint32_t vertices() const { return view.info->vertices; }
  [[nodiscard]] std::uint32_t free() const { return view.info->free; }
};

/// The body in an arena; null while that counts. Start-up; work: linear in the model.
[[nodiscard]] ElasticBody* place_elastic_body(Arena& arena, const MultigridView& view,
                                              std::uint32_t max_holds) noexcept;

/// Fills what place_elastic_body has carved: the body at rest. Start-up; work: linear in the model.
void begin_elastic_body(ElasticBody& body) noexcept;

// Work units: instructions of x86-64.

/// Of frames and the residual of a state. Constant.
[[nodiscard]] std::uint64_t residual_work(const MultigridView& view) noexcept;
/// Of a pass but for its iterations. Constant.
[[nodiscard]] std::uint64_t pass_work(const MultigridView& view) noexcept;
/// Of the operator times a field. Constant.
[[nodiscard]] std::uint64_t product_work(const MultigridView& view) noexcept;
/// Of one iteration of conjugate gradients: a cycle and a product. Constant.
[[nodiscard]] std::uint64_t iteration_work(const MultigridView& view) noexcept;
/// Of the displacements of all shown vertices, and of the stress of all vertices. Constant.
[[nodiscard]] std::uint64_t shown_work(const MultigridView& view) noexcept;
[[nodiscard]] std::uint64_t stress_work(const MultigridView& view) noexcept;
/// Of a step but for passes and iterations, with so many loads and holds. Constant.
[[nodiscard]] std::uint64_t state_work(const MultigridView& view, std::uint32_t loads, std::uint32_t holds) noexcept;

}  // namespace greenloop
