#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/store/elements.hpp"

namespace greenloop {

/// Everything in a store but the Green's functions themselves. n surface vertices, v volume vertices.
struct GreenStoreContents {
  SemiRegularMesh surface;           ///< m
  std::vector<double> area;          ///< n lumped areas, m^2, > 0
  std::vector<std::uint32_t> flags;  ///< n sums of layout::NodeFlag
  std::vector<int> row_node;         ///< surface vertices whose displacement is stored, strictly increasing
  std::vector<int> column_node;      ///< surface vertices that carry unit loads, strictly increasing
  int components = 3;                ///< N numbers of a load and of its answer at a node: 3, or 1 of a scalar problem
  std::string unit = "m/N";          ///< answer per load; m/N with 3 components

  TetrahedralMesh volume;                                      ///< m; empty when the columns come from elsewhere
  std::vector<std::uint8_t> volume_fixed;                      ///< v, nonzero = fixed
  Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation;  ///< n x v weights: surface from volume displacement

  double young = 0.0;                    ///< Pa; 0 of a scalar problem
  double poisson = 0.0;                  ///< dimensionless; 0 of a scalar problem
  Elements elements = Elements::linear;  ///< what the volume is solved with
  std::string provenance;                ///< JSON text
  std::string fingerprint;               ///< hexadecimal hash of all that determines the columns
};

/// Green's functions in force form, U = displacement [m] per unit nodal force [N], or of a scalar problem its answer
/// per unit nodal load in the unit of the contents, in an HDF5 file whose layout is described in docs/store.md. Columns
/// may arrive in any order and are marked done only after they are in the file, so a process killed while writing
/// leaves a store that opens and knows what it lacks. Offline only; one writer. Every error is a std::runtime_error
/// naming file, dataset and remedy.
class GreenStore {
 public:
  enum class Access { kReadOnly, kReadWrite };

  /// Creates (or replaces) the file with all its datasets and no column done; it appears under its name only when
  /// complete. Throws std::invalid_argument when the contents contradict each other, std::runtime_error if another
  /// process uses the file that stands there, or has made it meanwhile.
  [[nodiscard]] static GreenStore create(const std::filesystem::path& path, const GreenStoreContents& contents);

  /// Throws std::runtime_error if another process uses the file.
  static void require_free(const std::filesystem::path& path);

  /// Opens an existing store and checks types, shapes, units, indices and finiteness of everything but the columns,
  /// shapes against the length of the file before anything is allocated. Refuses links, external, virtual, chunked and
  /// filtered datasets, and datasets that share bytes. Memory and work: linear in the file without its columns.
  [[nodiscard]] static GreenStore open(const std::filesystem::path& path, Access access);

  ~GreenStore();
  GreenStore(GreenStore&&) noexcept;
  GreenStore& operator=(GreenStore&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const GreenStoreContents& contents() const;
  [[nodiscard]] int row_count() const;     ///< R
  [[nodiscard]] int column_count() const;  ///< C; each stands for N unit loads

  /// Throws unless the store is of so many components: for who takes no other.
  void require_components(int components) const;

  [[nodiscard]] bool is_done(int column) const;
  [[nodiscard]] std::vector<int> missing_columns() const;

  /// Writes columns first .. first + k - 1 and marks them done. `displacement` is N R x N k, in the contents' unit: row
  /// N r + i is component i at row node r, column N c + j the unit load of component j at column node first + c.
  /// Refuses values that are not finite.
  void write_columns(int first, const Eigen::Ref<const Eigen::MatrixXd>& displacement);

  /// Whether there is room for what a uniform force on the body's volume does: in new stores with a volume.
  [[nodiscard]] bool has_body_force_room() const;
  [[nodiscard]] bool is_body_force_done() const;

  /// What a uniform force of 1 N/m^3 along x, y and z does, 3 R x 3 in m: row 3 r + i is axis i at row node r.
  void write_body_force(const Eigen::MatrixXd& displacement);
  /// The same; it must be done and equal its checksum.
  [[nodiscard]] Eigen::MatrixXd read_body_force() const;

  /// Closes the file, throwing if something was lost; the store is not to be used afterwards. Columns are safe without.
  void close();

  /// Columns first .. first + count - 1 as N R x N count, laid out as in write_columns; all must be done, equal their
  /// checksums if the store has such, and not be all zero.
  [[nodiscard]] Eigen::MatrixXd read_columns(int first, int count) const;

  /// The same, of the row nodes first_row .. first_row + row_count - 1 only. A column is read as a whole, once, to be
  /// checked.
  [[nodiscard]] Eigen::MatrixXd read_block(int first_row, int row_count, int first_column, int column_count) const;

 private:
  struct File;
  explicit GreenStore(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace greenloop
