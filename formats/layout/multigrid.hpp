#pragma once

// The sections of a multigrid model (Georgii & Westermann 2005): an elastic body of linear tetrahedra that moves, and
// *grids*, the levels of its operator. In this order, after Info and Provenance:
//
//   Level(0)          nothing of its own
//   Points            f32 [vertices][3], m: at rest; free vertices first
//   Tetrahedra        TetrahedronRecord [tetrahedra]
//   Matters           MatterRecord [matters]
//   ShownPoints       f32 [shown vertices][3], m: at rest
//   ShownTriangles    u32 [triangles][3], of shown vertices
//   Bindings          BindingRecord [shown vertices]
//
// and for each grid g = 0 .. grids-1, finest first, all but the coarsest:
//
//   Grid(g)           GridRecord
//   RowStarts(g)      u32 [vertices + 1], of each row's blocks in Columns and Blocks
//   RowUppers(g)      u32 [vertices], the first of them right of the diagonal
//   Columns(g)        u32 [blocks], ascending in a row, without the diagonal
//   Blocks(g)         f32 [blocks][3 columns][4], fourth numbers 0
//   Inverses(g)       f32 [vertices][3][4], of the blocks on the diagonal
//   ParentStarts(g)   u32 [vertices + 1], of each row in Parents and Weights
//   Parents(g)        u32 [parents], vertices of grid g + 1
//   Weights(g)        f32 [parents]
//
// and last
//
//   CoarsestFactor    f64: rows of the Cholesky factor of the coarsest grid's operator, 1, 2, .. 3 vertices numbers
//                     each, with inverses on the diagonal
//
// The operator of grid 0 is (1 + stiffness_damping s) K + (4/dt^2 + mass_damping s) M for an average acceleration, with
// s = 2/dt, of the body at rest over its free vertices; with numerical damping as runtime/multigrid/newmark.hpp has it.

#include <cstddef>
#include <cstdint>

#include "formats/layout/header.hpp"

namespace greenloop::layout {

inline constexpr std::uint32_t most_grids = 12;
inline constexpr std::uint32_t most_matters = 256;
inline constexpr std::uint32_t most_coarsest_vertices = 512;

/// How strain is measured: MultigridInfo::strain.
enum class Strain : std::uint32_t { linear = 0, corotational = 1, green = 2 };

struct MultigridInfo {
  std::uint32_t problem;     ///< Problem
  std::uint32_t components;  ///< 3
  std::uint32_t levels;      ///< 1: a part of a body is none
  std::uint32_t strain;      ///< Strain
  std::uint32_t vertices;
  std::uint32_t free;  ///< vertices that are not held for good: the first ones
  std::uint32_t tetrahedra;
  std::uint32_t matters;
  std::uint32_t shown;  ///< vertices of the surface that is shown
  std::uint32_t triangles;
  std::uint32_t grids;  ///< with the coarsest, 1..most_grids
  std::uint32_t coarsest_vertices;
  double time_step;         ///< s, of a step
  float mass_damping;       ///< 1/s, Rayleigh's alpha
  float stiffness_damping;  ///< s, Rayleigh's beta
  float numerical_damping;  ///< 0..1, Newmark's gamma beyond 1/2; 0: average acceleration
  float size;               ///< m, diagonal of the box of the body at rest
  float gravity[3];         ///< m/s^2, of a step that names none
  std::uint8_t reserved[172];
};
static_assert(sizeof(MultigridInfo) == 256 && offsetof(MultigridInfo, problem) == offsetof(InfoStart, problem));

struct MultigridLevelRecord {
  std::uint8_t reserved[64];
};
static_assert(sizeof(MultigridLevelRecord) == 64);

struct TetrahedronRecord {
  std::uint32_t vertex[4];  ///< positively oriented
  std::uint32_t matter;
};
static_assert(sizeof(TetrahedronRecord) == 20);

struct MatterRecord {
  float lambda, mu;  ///< Pa, Lame's constants
  float density;     ///< kg/m^3
  float reserved;
};
static_assert(sizeof(MatterRecord) == 16);

/// A shown vertex moves as this sum of vertices does.
struct BindingRecord {
  std::uint32_t vertex[4];
  float weight[4];
};
static_assert(sizeof(BindingRecord) == 32);

struct GridRecord {
  std::uint32_t vertices;
  std::uint32_t blocks;  ///< beside the diagonal
  std::uint32_t parents;
  std::uint32_t coarser;  ///< vertices of grid g + 1
};
static_assert(sizeof(GridRecord) == 16);

}  // namespace greenloop::layout
