#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/view.hpp"
#include "runtime/compliance/base_columns.hpp"
#include "runtime/compliance/capacitance.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/compliance/mirrored_couplings.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/glide.hpp"
#include "runtime/elastostatic/known_forces.hpp"
#include "runtime/elastostatic/last_answer.hpp"
#include "runtime/elastostatic/mixed_contacts.hpp"
#include "runtime/elastostatic/requirement.hpp"
#include "runtime/elastostatic/unilateral.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/factor/factor_job.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"
#include "runtime/wavelet/wavelet.hpp"

namespace greenloop {

struct Accepted;
struct Plan;

/// What a body keeps of what acts on it beside its contacts.
struct LoadState {
  KnownForces forces;                 ///< of a step
  std::uint32_t amounts = 0;          ///< loads of the model that act in it
  std::uint32_t* load = nullptr;      ///< [loads of the model] those
  float* amount = nullptr;            ///< [loads of the model] of each, over the stiffness scale
  float* largest = nullptr;           ///< [loads of the model] m a unit, no displacement is larger
  LoadCounts counts;                  ///< of the plan
  Constraint* held = nullptr;         ///< [contacts] among constraints of other kinds
  float* held_force = nullptr;        ///< [3 * contacts]
  float* column_displaced = nullptr;  ///< [3 * columns] by the loads alone
  Float4* displaced = nullptr;        ///< [domain], zero between steps
  // of selected answers
  std::uint32_t* point_column = nullptr;  ///< [3 * points]
  std::uint32_t* asked_column = nullptr;  ///< [contacts + forces]
  float* asked_force = nullptr;           ///< [3 * (contacts + forces)]

  [[nodiscard]] ActingLoads acting() const noexcept { return {amounts, load, amount}; }
};

/// Everything that a body keeps in its arena.
struct Body {
  const ModelView* view = nullptr;  ///< its own
  ModelCounts counts;
  std::uint64_t least_work = 0;
  float force_limit = 0;  ///< N: forces whose magnitudes sum to no more cannot overflow the field
  float stiffness = 1;    ///< of a step, over the model's; all that is kept is of the model's
  Lifting lifting;
  Refinement refinement;
  MirroredCouplings mirrored;
  BlockSums<3> block_sums = portable_block_sums<3>();
  FieldBlocks field_blocks;
  BaseColumns base;
  AddTiles<3> add_tiles = greenloop::add_tiles<3>;
  CoefficientSums<3> field_sums{};  ///< zero between steps
  PredictionOffsets<3> offsets;     ///< empty without fields
  std::uint32_t* stored = nullptr;  ///< [domain] blocks of all layers in a coefficient's column
  ColumnCosts cost;
  NodeFacts* facts = nullptr;  ///< [node_count]
  ResolutionScratch resolution;
  ContactSet planned;  ///< the set that a step is answered with
  ContactSet other;    ///< the same contacts on the level before, and then on the one that is prepared
  Touched touched;     ///< by the planned set
  CapacitanceScratch<3> capacitance;
  FactorChanges changes;  ///< what tells the nearest cached factor from the planned set
  FactorScratch factoring;
  const FactorTools<3>* tools = nullptr;  ///< of this body, once for all steps
  Float4* solution = nullptr;             ///< of a set's columns in the order of its factor
  float* column_force = nullptr;          ///< [3 * columns] of the planned set
  float* other_column_force = nullptr;
  float* older_force = nullptr;  ///< [3 * contacts] by the level before
  Float4* force = nullptr;       ///< [domain], zero between steps
  LoadState* loads = nullptr;    ///< null where the limits ask for none
  FactorCache cache;
  FactorJob job;  ///< the factor of a finer level
  LastAnswer last;
  bool answered = false;       ///< `planned` is the set of the last answer
  bool pushed = false;         ///< the last answer is that of unilateral contacts
  std::uint32_t surfaces = 0;  ///< how many
  bool is_loaded = false;      ///< something but contacts acts in the step
  Glide glide;
  UnilateralScratch unilateral;  ///< without room unless unilateral contacts are allowed
  MixedScratch mixed;            ///< without room unless mixed contacts are
  // of a step, kept off the stack
  Accepted* accepted = nullptr;
  Plan* plan = nullptr;
  const std::byte* last_red_zone = nullptr;

  [[nodiscard]] const FactorTools<3>& factor_tools() const { return *tools; }
  [[nodiscard]] FieldModel<3> field_model() const {
    return {refinement, mirrored, base, offsets, block_sums, add_tiles};
  }
  [[nodiscard]] FieldScratch<3> field_scratch() const { return {force, field_sums}; }
};

/// Carves a body's arrays and fills in what follows from the model. Null while `arena` only counts, and if
/// what is ready in the file is not made of this model. The bytes that `view` points to must outlive the body.
/// Start-up; linear in the model's nodes and, for every level, its blocks.
Body* place_body(Arena& arena, const ModelView& view, const BodySizes& sizes) noexcept;

}  // namespace greenloop
