#pragma once

#include <Eigen/Core>

#include "formats/store/hdf5_file.hpp"

namespace greenloop {

inline constexpr const char* kBodyForce = "/body_force/displacement";
inline constexpr const char* kBodyForceChecksum = "/body_force/checksum";
inline constexpr const char* kBodyForceDone = "/body_force/done";

/// What a uniform force on the volume of a body does, in a store with `rows` row nodes: three columns, m per N/m^3, of
/// forces along x, y and z. Each function throws std::runtime_error naming file and dataset.

/// Room for them in a file that is being made; nothing is done.
void reserve_body_force(Hdf5File& file, hsize_t rows);

/// Whether a store has room for them; if so, its shapes, unit and kinds of numbers are checked.
[[nodiscard]] bool has_body_force_room(const Hdf5File& file, hsize_t rows);

/// Whether they have been written.
[[nodiscard]] bool is_body_force_done(const Hdf5File& file);

/// Column j of `displacement`, 3 rows x 3, is what a force along axis j does; row 3 r + i is axis i at row node r.
/// Refuses values that are not finite.
void write_body_force(Hdf5File& file, hsize_t rows, const Eigen::MatrixXd& displacement);

/// The same; must be done and equal its checksum.
[[nodiscard]] Eigen::MatrixXd read_body_force(const Hdf5File& file, hsize_t rows);

}  // namespace greenloop
