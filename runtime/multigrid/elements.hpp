#pragma once

#include <cstdint>
#include <span>

#include "runtime/algebra/float4.hpp"

namespace greenloop {

/// A 3x3 matrix of each of four tetrahedra, [row][column].
struct Matrix4 {
  Float4 of[3][3];
};

/// Four linear tetrahedra side by side, one in each lane; lanes of none have vertex 0 and weigh nothing.
struct TetrahedronGroup {
  std::uint32_t vertex[4][4];  ///< [corner][lane]
  Float4 gradient[3][3];       ///< of the barycentric coordinates of corners 1, 2, 3, 1/m; that of 0 is minus their sum
  Float4 lambda, mu;           ///< Lame's constants times the volume, J
  Float4 mass;                 ///< kg
  Float4 volume;               ///< m^3
};

/// Displacement gradients of four tetrahedra, from fields of vectors with fourth lanes of 0. For the loop; constant.
[[nodiscard]] Matrix4 gradient_of(const TetrahedronGroup& group, const Float4* displacement) noexcept;

/// How a body is strained: every measure is a stress of a frame A of each tetrahedron, P = A sigma, and its change for
/// a held frame is A C sym(A^T dG): of linear strain A = 1; of corotational strain (Müller & Gross 2004) A is the
/// rotation of the deformation gradient F; of Green's strain A = F, and what the stress does while F turns is left out
/// of the change, so that it stays semidefinite under pressure.
enum class StrainMeasure : std::uint8_t { linear, corotational, green };

/// Rotations of four tetrahedra as quaternions, x y z w, kept from step to step.
struct Quaternion4 {
  Float4 x, y, z, w;
};

/// Turns `rotation` towards the rotation of F = 1 + gradient by Newton's method on the sphere of rotations (Müller et
/// al. 2016, with the Hessian of the polar decomposition): a rotation whatever F is, inside out too; quadratically
/// convergent near F's own. For the loop; constant.
void follow_rotation(const Matrix4& gradient, Quaternion4& rotation) noexcept;

[[nodiscard]] Matrix4 matrix_of(const Quaternion4& rotation) noexcept;

/// The frames of a state. quaternion: of corotational strain. For the loop; work: groups.
void find_frames(StrainMeasure measure, std::span<const TetrahedronGroup> groups, const Float4* displacement,
                 std::span<Quaternion4> quaternion, std::span<Matrix4> frame) noexcept;

/// sum -= elastic forces of `displacement` + viscous forces `damping` C rate + consistent mass times `inertia`. For the
/// loop; work: groups.
void subtract_forces(StrainMeasure measure, std::span<const TetrahedronGroup> groups, std::span<const Matrix4> frame,
                     const Float4* displacement, const Float4* rate, float damping, const Float4* inertia,
                     Float4* sum) noexcept;

/// sum = (stiffness K + mass M) x with held frames; [vertices]. For the loop; work: groups.
void multiply_elements(std::span<const TetrahedronGroup> groups, std::span<const Matrix4> frame, float stiffness,
                       float mass, const Float4* x, std::span<Float4> sum) noexcept;

/// sum = consistent mass times x; [vertices]. For the loop; work: groups.
void multiply_mass(std::span<const TetrahedronGroup> groups, const Float4* x, std::span<Float4> sum) noexcept;

/// Von Mises stress of four tetrahedra times their volumes, Pa m^3: of the stress in the frame (of Green's strain the
/// second of Piola and Kirchhoff). For the loop; constant.
[[nodiscard]] Float4 von_mises(StrainMeasure measure, const TetrahedronGroup& group, const Matrix4& frame,
                               const Float4* displacement) noexcept;

/// J, of a state with these frames. For the loop; work: groups.
[[nodiscard]] float elastic_energy(StrainMeasure measure, std::span<const TetrahedronGroup> groups,
                                   std::span<const Matrix4> frame, const Float4* displacement) noexcept;

}  // namespace greenloop
