#include "runtime/multigrid/answers.hpp"

#include <cstddef>

namespace greenloop {
namespace {

Vec3 vec3(Float4 x) { return {x[0], x[1], x[2]}; }

}  // namespace

void copy_displacements(const ElasticBody& body, std::span<const std::uint32_t> chosen, std::span<Vec3> to) noexcept {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i] = vec3(body.state.displacement[chosen.empty() ? i : chosen[i]]);
  }
}

void copy_shown(const ElasticBody& body, std::span<Vec3> to) noexcept {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const layout::BindingRecord& binding = body.view.bindings[i];
    Float4 sum{};
    for (std::size_t k = 0; k < 4; ++k) {
      sum += splat(binding.weight[k]) * body.state.displacement[binding.vertex[k]];
    }
    to[i] = vec3(sum);
  }
}

void copy_stress(const ElasticBody& body, std::span<float> to) noexcept {
  if (to.empty()) return;
  const std::span<Float4> sums = body.rest;  // stress times volume, and volume
  for (Float4& sum : sums) sum = Float4{};
  for (std::size_t g = 0; g < body.groups.size(); ++g) {
    const TetrahedronGroup& group = body.groups[g];
    const Float4 stress = von_mises(body.measure, group, body.frame[g], body.state.displacement.data());
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const Float4 share = Float4{stress[lane], group.volume[lane], 0, 0};
      for (std::size_t corner = 0; corner < 4; ++corner) sums[group.vertex[corner][lane]] += share;
    }
  }
  for (std::size_t v = 0; v < to.size(); ++v) to[v] = sums[v][1] > 0 ? sums[v][0] / sums[v][1] : 0;
}

}  // namespace greenloop
