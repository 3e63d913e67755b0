#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/layout.hpp"
#include "formats/store/green_store.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// What one unit of each of some loads does to a body.
struct LoadDisplacements {
  std::vector<layout::LoadRecord> records;
  Eigen::MatrixXd displacement;  ///< 3R x records.size(), m: row 3r + i is axis i at row node r of the store
};

/// Those of the loads that a scene asks for: of accelerations from the store's body force, which is solved if the store
/// lacks it, of pressures from the store's columns, all of which must be done. A pressure acts on
/// the finest triangles whose corners are all in its region, a third on each corner; that of a mask
/// by the integrals of its linear function with theirs, on nodes that have columns. Throws SceneError if there is no
/// such triangle, std::runtime_error if the body force cannot be solved. Work: one reading of the columns if there are
/// pressures.
[[nodiscard]] LoadDisplacements load_displacements(const Scene& scene, GreenStore& store);

}  // namespace greenloop::offline
