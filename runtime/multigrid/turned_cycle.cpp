#include "runtime/multigrid/turned_cycle.hpp"

#include <cmath>
#include <cstddef>

namespace greenloop {
namespace {

Float4 cross(Float4 a, Float4 b) {
  const Float4 product = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(product, product, 1, 2, 0, 3);
}

/// x turned by a quaternion x y z w of unit length.
Float4 turn(Float4 quaternion, Float4 x) {
  const Float4 axis = xyz(quaternion);
  const Float4 twice = splat(2.0F) * cross(axis, x);
  return (x + splat(quaternion[3]) * twice) + cross(axis, twice);
}

Float4 inverse(Float4 quaternion) { return quaternion * Float4{-1, -1, -1, 1}; }

float dot(Float4 a, Float4 b) {
  const Float4 product = a * b;
  return (product[0] + product[1]) + (product[2] + product[3]);
}

}  // namespace

void turn_vertices(ElasticBody& body) noexcept {
  if (body.measure == StrainMeasure::linear) return;
  for (Float4& sum : body.turned) sum = Float4{};
  for (std::size_t g = 0; g < body.groups.size(); ++g) {
    const Quaternion4& four = body.quaternion[g];
    const TetrahedronGroup& group = body.groups[g];
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const Float4 quaternion = Float4{four.x[lane], four.y[lane], four.z[lane], four.w[lane]};
      const Float4 weighted = splat(group.mass[lane]) * quaternion;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::uint32_t v = group.vertex[corner][lane];
        if (v >= body.free()) continue;
        // q and -q are one rotation
        const bool opposite = dot(quaternion, body.vertex_quaternion[v]) < 0;
        body.turned[v] += opposite ? -weighted : weighted;
      }
    }
  }
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    const float square = dot(body.turned[v], body.turned[v]);
    if (square > 0) body.vertex_quaternion[v] = body.turned[v] * splat(1 / std::sqrt(square));
  }
}

void turned_cycle(ElasticBody& body, const Float4* r, Float4* z) noexcept {
  const MultigridCycle::Fields& finest = body.fields[0];
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    finest.b[v] = turn(inverse(body.vertex_quaternion[v]), splat(body.moves[v]) * r[v]);
  }
  v_cycle(body.cycle);
  for (std::uint32_t v = 0; v < body.free(); ++v) {
    z[v] = turn(body.vertex_quaternion[v], splat(body.moves[v]) * finest.x[v]);
  }
}

}  // namespace greenloop
