#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/compress/wavelet/exact_columns.hpp"

namespace greenloop::offline {

/// A body whose exact compliance can be read.
struct ExactBody {
  std::string name;
  SemiRegularMesh mesh;
  std::vector<std::uint32_t> flags;  ///< layout::NodeFlag per node
  std::vector<double> area;          ///< m^2 per node
  ExactColumns columns;              ///< of the domain nodes, in node order
};

/// Opens a store of Green's functions; it is read as columns are asked for. Throws std::runtime_error naming the file
/// if it cannot be read, lacks columns, or has no column for a node of its domain.
[[nodiscard]] ExactBody open_body(const std::filesystem::path& store);

}  // namespace greenloop::offline
