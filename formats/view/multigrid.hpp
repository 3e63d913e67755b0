#pragma once

#include <cstdint>
#include <span>

#include "formats/layout/multigrid.hpp"

namespace greenloop {

/// One grid of a multigrid model, in place.
struct GridView {
  std::uint32_t vertices = 0;
  const std::uint32_t* row_starts = nullptr;  ///< [vertices + 1]
  const std::uint32_t* row_uppers = nullptr;  ///< [vertices]
  std::span<const std::uint32_t> columns;
  const float* blocks = nullptr;    ///< [columns][3][4]
  const float* inverses = nullptr;  ///< [vertices][3][4]
  const std::uint32_t* parent_starts = nullptr;
  std::span<const std::uint32_t> parents;
  const float* weights = nullptr;  ///< [parents]
};

/// A multigrid model, in place.
struct MultigridView {
  const layout::MultigridInfo* info = nullptr;
  const float* points = nullptr;  ///< [vertices][3]
  std::span<const layout::TetrahedronRecord> tetrahedra;
  const layout::MatterRecord* matters = nullptr;
  const float* shape = nullptr;  ///< [shown][3]
  const std::uint32_t* triangles = nullptr;
  std::span<const layout::BindingRecord> bindings;
  GridView grid[layout::most_grids];  ///< all but the coarsest
  std::span<const double> coarsest_factor;
};

}  // namespace greenloop
