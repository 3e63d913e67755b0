#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/layout.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {

/// One grid of a multigrid model before encoding, in the order of layout/multigrid.hpp.
struct GridData {
  std::vector<std::uint32_t> row_starts, row_uppers, columns;
  std::vector<float> blocks, inverses;  ///< 12 a block
  std::vector<std::uint32_t> parent_starts, parents;
  std::vector<float> weights;
};

/// A whole multigrid model before encoding. Offline only.
struct MultigridData {
  layout::MultigridInfo info{};  ///< counts are filled in, but for `free`
  std::string provenance;
  std::vector<float> points;  ///< m, [vertices][3]
  std::vector<layout::TetrahedronRecord> tetrahedra;
  std::vector<layout::MatterRecord> matters;
  std::vector<float> shown_points;             ///< m, [shown][3]
  std::vector<std::uint32_t> shown_triangles;  ///< [triangles][3]
  std::vector<layout::BindingRecord> bindings;
  std::vector<GridData> grids;  ///< all but the coarsest
  std::uint32_t coarsest_vertices = 0;
  std::vector<double> coarsest_factor;
};

/// The file of such a model: deterministic, complete, checksummed, verified. Throws std::invalid_argument naming the
/// field that does not fit.
[[nodiscard]] ModelFile encoded_file(const MultigridData& model);

/// The bytes of that file.
[[nodiscard]] std::vector<std::byte> encode(const MultigridData& model);

}  // namespace greenloop
