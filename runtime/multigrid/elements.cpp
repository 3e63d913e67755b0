#include "runtime/multigrid/elements.hpp"

#include <cmath>
#include <cstddef>

namespace greenloop {
namespace {

/// Three numbers of each of four vertices or tetrahedra.
struct Vector4 {
  Float4 of[3];
};

Vector4 gather(const std::uint32_t (&vertex)[4], const Float4* field) {
  const Float4 a = field[vertex[0]], b = field[vertex[1]], c = field[vertex[2]], d = field[vertex[3]];
  const Float4 low_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), low_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Float4 high_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7), high_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {{__builtin_shufflevector(low_ab, low_cd, 0, 1, 4, 5), __builtin_shufflevector(low_ab, low_cd, 2, 3, 6, 7),
           __builtin_shufflevector(high_ab, high_cd, 0, 1, 4, 5)}};
}

/// field at the vertices += value
void scatter(const std::uint32_t (&vertex)[4], const Vector4& value, Float4* field) {
  const Float4 none{};
  const Float4 low = __builtin_shufflevector(value.of[0], value.of[1], 0, 4, 1, 5);
  const Float4 high = __builtin_shufflevector(value.of[0], value.of[1], 2, 6, 3, 7);
  const Float4 low_z = __builtin_shufflevector(value.of[2], none, 0, 4, 1, 5);
  const Float4 high_z = __builtin_shufflevector(value.of[2], none, 2, 6, 3, 7);
  field[vertex[0]] += __builtin_shufflevector(low, low_z, 0, 1, 4, 5);
  field[vertex[1]] += __builtin_shufflevector(low, low_z, 2, 3, 6, 7);
  field[vertex[2]] += __builtin_shufflevector(high, high_z, 0, 1, 4, 5);
  field[vertex[3]] += __builtin_shufflevector(high, high_z, 2, 3, 6, 7);
}

Float4 square_root(const Float4& of) {
  return Float4{std::sqrt(of[0]), std::sqrt(of[1]), std::sqrt(of[2]), std::sqrt(of[3])};
}

/// a^T b
Matrix4 transposed_product(const Matrix4& a, const Matrix4& b) {
  Matrix4 result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result.of[i][j] = (a.of[0][i] * b.of[0][j] + a.of[1][i] * b.of[1][j]) + a.of[2][i] * b.of[2][j];
    }
  }
  return result;
}

/// A symmetric matrix: xx, yy, zz, yz, xz, xy.
struct Symmetric4 {
  Float4 of[6];
};

Symmetric4 symmetric_part(const Matrix4& m) {
  const Float4 half = splat(0.5F);
  return {{m.of[0][0], m.of[1][1], m.of[2][2], half * (m.of[1][2] + m.of[2][1]), half * (m.of[0][2] + m.of[2][0]),
           half * (m.of[0][1] + m.of[1][0])}};
}

Matrix4 with_identity(const Matrix4& gradient) {
  Matrix4 result = gradient;
  for (int i = 0; i < 3; ++i) result.of[i][i] += splat(1.0F);
  return result;
}

/// Of a state: the strain that the measure makes of a gradient.
Symmetric4 strain_of(StrainMeasure measure, const Matrix4& frame, const Matrix4& gradient) {
  if (measure == StrainMeasure::linear) return symmetric_part(gradient);
  if (measure == StrainMeasure::corotational) {
    Symmetric4 strain = symmetric_part(transposed_product(frame, with_identity(gradient)));
    for (int i = 0; i < 3; ++i) strain.of[i] -= splat(1.0F);
    return strain;
  }
  // (F^T F - 1) / 2 = sym(G) + G^T G / 2
  Symmetric4 strain = symmetric_part(gradient);
  const Symmetric4 square = symmetric_part(transposed_product(gradient, gradient));
  for (int i = 0; i < 6; ++i) strain.of[i] += splat(0.5F) * square.of[i];
  return strain;
}

/// Hooke's law: lambda tr(strain) + 2 mu strain.
Symmetric4 stress_of(const TetrahedronGroup& group, const Symmetric4& strain) {
  const Float4 twice = group.mu + group.mu;
  const Float4 pressure = group.lambda * ((strain.of[0] + strain.of[1]) + strain.of[2]);
  Symmetric4 stress;
  for (int i = 0; i < 6; ++i) stress.of[i] = twice * strain.of[i];
  for (int i = 0; i < 3; ++i) stress.of[i] += pressure;
  return stress;
}

/// frame * stress
Matrix4 product(const Matrix4& frame, const Symmetric4& s) {
  Matrix4 result;
  for (int i = 0; i < 3; ++i) {
    const Float4(&row)[3] = frame.of[i];
    result.of[i][0] = (row[0] * s.of[0] + row[1] * s.of[5]) + row[2] * s.of[4];
    result.of[i][1] = (row[0] * s.of[5] + row[1] * s.of[1]) + row[2] * s.of[3];
    result.of[i][2] = (row[0] * s.of[4] + row[1] * s.of[3]) + row[2] * s.of[2];
  }
  return result;
}

/// What each corner gets from a stress, corner 0 last.
struct CornerForces {
  Vector4 corner[4];
};

CornerForces forces_of(const TetrahedronGroup& group, const Matrix4& stress) {
  CornerForces forces;
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) {
      const Float4(&g)[3] = group.gradient[a];
      forces.corner[a + 1].of[i] = (stress.of[i][0] * g[0] + stress.of[i][1] * g[1]) + stress.of[i][2] * g[2];
    }
    forces.corner[0].of[i] = -((forces.corner[1].of[i] + forces.corner[2].of[i]) + forces.corner[3].of[i]);
  }
  return forces;
}

/// Adds scale times the consistent mass times a field: mass / 20 (sum of the corners + the corner).
void add_inertia(const TetrahedronGroup& group, float scale, const Float4* field, CornerForces& forces) {
  const Float4 share = group.mass * splat(0.05F * scale);
  Vector4 corner[4];
  for (int a = 0; a < 4; ++a) corner[a] = gather(group.vertex[a], field);
  for (int i = 0; i < 3; ++i) {
    const Float4 sum = (corner[0].of[i] + corner[1].of[i]) + (corner[2].of[i] + corner[3].of[i]);
    for (int a = 0; a < 4; ++a) forces.corner[a].of[i] += share * (sum + corner[a].of[i]);
  }
}

void add_scaled(Symmetric4& sum, float scale, const Symmetric4& of) {
  for (int i = 0; i < 6; ++i) sum.of[i] += splat(scale) * of.of[i];
}

}  // namespace

Matrix4 gradient_of(const TetrahedronGroup& group, const Float4* displacement) noexcept {
  const Vector4 first = gather(group.vertex[0], displacement);
  Matrix4 gradient{};
  for (int a = 0; a < 3; ++a) {
    const Vector4 corner = gather(group.vertex[a + 1], displacement);
    for (int i = 0; i < 3; ++i) {
      const Float4 difference = corner.of[i] - first.of[i];
      for (int j = 0; j < 3; ++j) gradient.of[i][j] += difference * group.gradient[a][j];
    }
  }
  return gradient;
}

void follow_rotation(const Matrix4& gradient, Quaternion4& rotation) noexcept {
  const Matrix4 stretch = transposed_product(matrix_of(rotation), with_identity(gradient));
  const Float4 half = splat(0.5F);
  // R^T F = S + skew: half the turn that makes it symmetric solves (tr(S) - S) h = axis of the skew part
  const Float4 x = half * (stretch.of[2][1] - stretch.of[1][2]), y = half * (stretch.of[0][2] - stretch.of[2][0]),
               z = half * (stretch.of[1][0] - stretch.of[0][1]);
  const Symmetric4 s = symmetric_part(stretch);
  const Float4 a = s.of[1] + s.of[2], b = s.of[0] + s.of[2], c = s.of[0] + s.of[1];
  const Float4 yz = -s.of[3], xz = -s.of[4], xy = -s.of[5];
  const Float4 aa = b * c - yz * yz, bb = a * c - xz * xz, cc = a * b - xy * xy;
  const Float4 ab = xz * yz - xy * c, ac = xy * yz - xz * b, bc = xy * xz - yz * a;
  const Float4 determinant = (a * aa + xy * ab) + xz * ac;
  const Float4 least = splat(1.0e-3F);
  const auto small = determinant < least;
  // inside out, or nearly flat: a short step along the axis
  const Float4 scale = small ? Float4{} : splat(1.0F) / (small ? least : determinant);
  const auto turn = [&](Float4 p, Float4 q, Float4 r, Float4 axis) {
    const Float4 newton = ((p * x + q * y) + r * z) * scale;
    return small ? half * axis : newton;
  };
  const Float4 hx = turn(aa, ab, ac, x), hy = turn(ab, bb, bc, y), hz = turn(ac, bc, cc, z);
  // rotation * (h, 1), of unit length again
  const Quaternion4 q = rotation;
  const Quaternion4 turned = {((q.x + q.w * hx) + q.y * hz) - q.z * hy, ((q.y + q.w * hy) + q.z * hx) - q.x * hz,
                              ((q.z + q.w * hz) + q.x * hy) - q.y * hx, ((q.w - q.x * hx) - q.y * hy) - q.z * hz};
  const Float4 square = (turned.x * turned.x + turned.y * turned.y) + (turned.z * turned.z + turned.w * turned.w);
  const Float4 shorten = splat(1.0F) / square_root(square);
  rotation = {turned.x * shorten, turned.y * shorten, turned.z * shorten, turned.w * shorten};
}

Matrix4 matrix_of(const Quaternion4& q) noexcept {
  const Float4 x = q.x + q.x, y = q.y + q.y, z = q.z + q.z, one = splat(1.0F);
  const Float4 xx = q.x * x, yy = q.y * y, zz = q.z * z, xy = q.x * y, xz = q.x * z, yz = q.y * z;
  const Float4 wx = q.w * x, wy = q.w * y, wz = q.w * z;
  return {
      {{one - (yy + zz), xy - wz, xz + wy}, {xy + wz, one - (xx + zz), yz - wx}, {xz - wy, yz + wx, one - (xx + yy)}}};
}

void find_frames(StrainMeasure measure, std::span<const TetrahedronGroup> groups, const Float4* displacement,
                 std::span<Quaternion4> quaternion, std::span<Matrix4> frame) noexcept {
  if (measure == StrainMeasure::linear) return;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Matrix4 gradient = gradient_of(groups[g], displacement);
    if (measure == StrainMeasure::green) {
      frame[g] = with_identity(gradient);
      continue;
    }
    follow_rotation(gradient, quaternion[g]);
    follow_rotation(gradient, quaternion[g]);
    frame[g] = matrix_of(quaternion[g]);
  }
}

void subtract_forces(StrainMeasure measure, std::span<const TetrahedronGroup> groups, std::span<const Matrix4> frame,
                     const Float4* displacement, const Float4* rate, float damping, const Float4* inertia,
                     Float4* sum) noexcept {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const TetrahedronGroup& group = groups[g];
    Symmetric4 strain = strain_of(measure, frame[g], gradient_of(group, displacement));
    if (damping != 0) {
      add_scaled(strain, damping, symmetric_part(transposed_product(frame[g], gradient_of(group, rate))));
    }
    CornerForces forces = forces_of(group, product(frame[g], stress_of(group, strain)));
    add_inertia(group, 1.0F, inertia, forces);
    for (int a = 0; a < 4; ++a) {
      for (Float4& component : forces.corner[a].of) component = -component;
      scatter(group.vertex[a], forces.corner[a], sum);
    }
  }
}

void multiply_elements(std::span<const TetrahedronGroup> groups, std::span<const Matrix4> frame, float stiffness,
                       float mass, const Float4* x, std::span<Float4> sum) noexcept {
  for (Float4& value : sum) value = Float4{};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const TetrahedronGroup& group = groups[g];
    Symmetric4 strain = symmetric_part(transposed_product(frame[g], gradient_of(group, x)));
    for (Float4& component : strain.of) component *= splat(stiffness);
    CornerForces forces = forces_of(group, product(frame[g], stress_of(group, strain)));
    add_inertia(group, mass, x, forces);
    for (int a = 0; a < 4; ++a) scatter(group.vertex[a], forces.corner[a], sum.data());
  }
}

void multiply_mass(std::span<const TetrahedronGroup> groups, const Float4* x, std::span<Float4> sum) noexcept {
  for (Float4& value : sum) value = Float4{};
  for (const TetrahedronGroup& group : groups) {
    CornerForces forces{};
    add_inertia(group, 1.0F, x, forces);
    for (int a = 0; a < 4; ++a) scatter(group.vertex[a], forces.corner[a], sum.data());
  }
}

Float4 von_mises(StrainMeasure measure, const TetrahedronGroup& group, const Matrix4& frame,
                 const Float4* displacement) noexcept {
  const Symmetric4 s = stress_of(group, strain_of(measure, frame, gradient_of(group, displacement)));
  const Float4 a = s.of[0] - s.of[1], b = s.of[1] - s.of[2], c = s.of[2] - s.of[0];
  const Float4 normal = (a * a + b * b) + c * c;
  const Float4 shear = (s.of[3] * s.of[3] + s.of[4] * s.of[4]) + s.of[5] * s.of[5];
  return square_root(splat(0.5F) * normal + splat(3.0F) * shear);
}

float elastic_energy(StrainMeasure measure, std::span<const TetrahedronGroup> groups, std::span<const Matrix4> frame,
                     const Float4* displacement) noexcept {
  Float4 sum{};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Symmetric4 strain = strain_of(measure, frame[g], gradient_of(groups[g], displacement));
    const Symmetric4 stress = stress_of(groups[g], strain);
    Float4 twice{};
    for (int i = 0; i < 3; ++i) twice += stress.of[i] * strain.of[i];
    for (int i = 3; i < 6; ++i) twice += splat(2.0F) * stress.of[i] * strain.of[i];
    sum += splat(0.5F) * twice;
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace greenloop
