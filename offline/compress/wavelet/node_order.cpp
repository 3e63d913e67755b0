#include "offline/compress/wavelet/node_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "formats/layout.hpp"

namespace greenloop::offline {
namespace {

constexpr int morton_bits = 20;

void require_flags(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags) {
  if (flags.size() != mesh.positions.size()) {
    throw std::invalid_argument("node order: " + std::to_string(flags.size()) + " node flags for " +
                                std::to_string(mesh.positions.size()) + " nodes; give one per node");
  }
}

/// Spreads the low bits of `value` so that two zero bits follow each.
std::uint64_t spread_bits(std::uint64_t value) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < morton_bits; ++bit) spread |= ((value >> bit) & 1U) << (3 * bit);
  return spread;
}

std::vector<std::uint64_t> morton_codes(const SemiRegularMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& position : mesh.positions) box.extend(position);
  const double extent = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  if (!(extent > 0)) throw std::invalid_argument("node order: the mesh has no extent; its vertices coincide");
  const double cells = static_cast<double>((1U << morton_bits) - 1);
  std::vector<std::uint64_t> codes;
  codes.reserve(mesh.positions.size());
  for (const auto& position : mesh.positions) {
    const Eigen::Vector3d cell = (position - box.min()) * (cells / extent);
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) code |= spread_bits(static_cast<std::uint64_t>(cell[axis])) << axis;
    codes.push_back(code);
  }
  return codes;
}

}  // namespace

std::vector<std::uint32_t> mark_domain(const SemiRegularMesh& mesh, std::vector<std::uint32_t> flags) {
  require_flags(mesh, flags);
  for (auto& flag : flags) {
    const bool needed = (flag & (layout::node_touchable | layout::node_read)) != 0;
    const bool fixed = (flag & layout::node_fixed) != 0;
    flag = needed && !fixed ? flag | layout::node_domain : flag & ~layout::node_domain;
  }
  // finest nodes first: a parent is always coarser, so one sweep closes the set
  for (std::size_t node = flags.size(); node-- > mesh.vertex_end.front();) {
    if ((flags[node] & layout::node_domain) == 0) continue;
    for (const int parent : mesh.parents[node]) {
      auto& flag = flags[static_cast<std::size_t>(parent)];
      if ((flag & layout::node_fixed) == 0) flag |= layout::node_domain;
    }
  }
  return flags;
}

OrderedMesh order_nodes(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags) {
  require_flags(mesh, flags);
  const auto codes = morton_codes(mesh);
  OrderedMesh ordered;
  ordered.source.resize(mesh.positions.size());
  std::iota(ordered.source.begin(), ordered.source.end(), std::size_t{0});
  const auto place = [&](std::size_t node) {
    return std::tuple((flags[node] & layout::node_domain) == 0, codes[node], node);
  };
  std::size_t begin = 0;
  for (const std::size_t end : mesh.vertex_end) {
    std::sort(ordered.source.begin() + static_cast<std::ptrdiff_t>(begin),
              ordered.source.begin() + static_cast<std::ptrdiff_t>(end),
              [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    begin = end;
  }

  std::vector<int> renamed(mesh.positions.size());
  for (std::size_t node = 0; node < renamed.size(); ++node) renamed[ordered.source[node]] = static_cast<int>(node);
  const auto rename = [&](int old) { return old < 0 ? old : renamed[static_cast<std::size_t>(old)]; };
  ordered.mesh.vertex_end = mesh.vertex_end;
  ordered.mesh.positions = ordered.reorder(mesh.positions);
  ordered.mesh.parents = ordered.reorder(mesh.parents);
  for (auto& [low, high] : ordered.mesh.parents) std::tie(low, high) = std::minmax({rename(low), rename(high)});
  ordered.mesh.base_triangles = mesh.base_triangles;
  for (auto& triangle : ordered.mesh.base_triangles) {
    for (int& corner : triangle) corner = rename(corner);
  }
  return ordered;
}

}  // namespace greenloop::offline
