#pragma once

#include <Eigen/Core>
#include <functional>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/store/material.hpp"
#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline::test {

using Region = std::function<bool(const Eigen::Vector3d&)>;  ///< of positions, m

/// A body filled with tetrahedra and solved as the product does it; every free node may be touched and is read.
/// `surface` closed, m. Throws what tetrahedralize and solve_green_functions throw.
[[nodiscard]] Body solve_body(const SemiRegularMesh& surface, const Region& fixed, const Material& material);

/// A ball whose upper half is drawn out to a blade: 2.2 m tall, 1.2 m wide and at most 16 cm thick.
[[nodiscard]] SemiRegularMesh eared_ball(int levels);

/// A bowl 2 m across and at most 8 cm thick, with a sharp rim.
[[nodiscard]] SemiRegularMesh sharp_bowl(int levels);

}  // namespace greenloop::offline::test
