#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "formats/store/green_store.hpp"

namespace greenloop {

/// The name of a file in the folder for temporary files, removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path path;
};

/// An octahedron split once; `columns` of its 18 vertices are column nodes, all but the first are rows.
[[nodiscard]] GreenStoreContents small_contents(int columns);

/// The same surface; one number a node.
[[nodiscard]] GreenStoreContents scalar_contents(int columns);

/// Recognisable values for column `column`.
[[nodiscard]] Eigen::MatrixXd column_values(int column, int rows, int components = 3);

}  // namespace greenloop
