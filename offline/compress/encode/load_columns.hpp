#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/write/writer.hpp"

namespace greenloop::offline {

/// Gives a model that is otherwise complete its loads: `displacement`, 3 rows x loads.size(), is what one unit of each
/// does, m, row 3r + i axis i at the domain node of row r. They are stored as the coefficients of the model's own
/// wavelet, in single precision. Throws std::invalid_argument if the sizes do not fit or the model does not encode.
/// Work: that of encoding, and one transform. Offline only.
void add_loads(std::vector<layout::LoadRecord> loads, const Eigen::MatrixXd& displacement, ModelData& model);

}  // namespace greenloop::offline
