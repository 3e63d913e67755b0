#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop::offline::test {

// Numbers of a node, as the types of test cases that hold for both.
using Scalars = std::integral_constant<unsigned, 1>;
using Vectors = std::integral_constant<unsigned, 3>;

/// An icosahedron split `levels` times and projected onto the unit sphere.
[[nodiscard]] SemiRegularMesh icosphere(int levels);

/// An octahedron split `levels` times and projected onto the unit sphere.
[[nodiscard]] SemiRegularMesh octasphere(int levels);

/// A ring of 40 vertices split `levels` times, projected onto the torus around z with a circle of radius 1 in its
/// middle and a tube of radius `torus_tube`.
[[nodiscard]] SemiRegularMesh torus(int levels);
inline constexpr double torus_tube = 0.5;

/// The icosphere's connectivity on a lobed blob about 1.5 m across.
[[nodiscard]] SemiRegularMesh blob(int levels);

/// A flat unit square of two triangles split `levels` times; it has a border.
[[nodiscard]] SemiRegularMesh square(int levels);

/// A third of the area of the finest triangles around each node [m^2].
[[nodiscard]] std::vector<double> nodal_area(const SemiRegularMesh& mesh);

/// A lobed body held on its underside, ordered, with a symmetric positive definite compliance of N numbers a node.
struct Body {
  SemiRegularMesh mesh;
  std::vector<std::uint32_t> flags;
  std::vector<double> area;
  std::vector<std::size_t> column_nodes;  ///< every free node
  Eigen::MatrixXd compliance;             ///< m/N, N per domain node
};

/// N = 3: made-up but physical, regularised Kelvin solutions (de Goes & James 2017, equation 6) with the fixed nodes
/// constrained to zero. N = 1: the inverse of the cotangent Laplacian plus a lumped mass, that is a potential on the
/// surface that leaks within about `screening_length` and is zero at the fixed nodes; of the order of 1.
template <unsigned N = 3>
[[nodiscard]] Body make_body(int levels);
inline constexpr double screening_length = 1;  // m

}  // namespace greenloop::offline::test
