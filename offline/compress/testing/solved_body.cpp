#include "offline/compress/testing/solved_body.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "formats/layout.hpp"
#include "formats/store/green_store.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/compress/wavelet/node_order.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/green_functions.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline::test {
namespace {

GreenStoreContents problem(const Body& body, const Material& material) {
  GreenStoreContents contents;
  contents.surface = body.mesh;
  contents.area = body.area;
  contents.flags = body.flags;
  contents.row_node.assign(body.column_nodes.begin(), body.column_nodes.end());
  contents.column_node = contents.row_node;
  contents.volume = tetrahedralize(finest_surface(body.mesh)).mesh;
  const auto vertices = contents.volume.vertices.size();
  contents.volume_fixed.assign(vertices, 0);
  for (std::size_t node = 0; node < body.flags.size(); ++node) {
    contents.volume_fixed[node] = (body.flags[node] & layout::node_fixed) != 0 ? 1 : 0;
  }
  contents.interpolation = select_first_vertices(static_cast<int>(body.flags.size()), static_cast<int>(vertices));
  contents.young = material.young;
  contents.poisson = material.poisson;
  contents.fingerprint = "00";
  return contents;
}

template <class Move>
SemiRegularMesh moved(SemiRegularMesh mesh, const Move& move) {
  for (auto& position : mesh.positions) position = move(position);
  return mesh;
}

}  // namespace

Body solve_body(const SemiRegularMesh& surface, const Region& fixed, const Material& material) {
  std::vector<std::uint32_t> flags;
  for (const auto& position : surface.positions) {
    flags.push_back(fixed(position) ? layout::node_fixed : layout::node_touchable | layout::node_read);
  }
  flags = mark_domain(surface, std::move(flags));
  auto ordered = order_nodes(surface, flags);
  Body body;
  body.flags = ordered.reorder(flags);
  body.mesh = std::move(ordered.mesh);
  body.area = nodal_area(body.mesh);
  for (std::size_t node = 0; node < body.flags.size(); ++node) {
    if ((body.flags[node] & layout::node_domain) != 0) body.column_nodes.push_back(node);
  }
  const TemporaryFolder folder("greenloop-solved");
  auto store = GreenStore::create(folder.path() / "solved.h5", problem(body, material));
  (void)solve_green_functions(store);
  body.compliance = store.read_columns(0, store.column_count());
  return body;
}

SemiRegularMesh eared_ball(int levels) {
  return moved(octasphere(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const double drawn = std::clamp(2.5 * (x.z() + 0.1), 0.0, 1.0);  // nothing below, a blade from the middle on
    return {x.x() * (1 - 0.92 * drawn), x.y() * (1 - 0.4 * drawn), x.z() < 0 ? x.z() : 2.2 * x.z()};
  });
}

SemiRegularMesh sharp_bowl(int levels) {
  return moved(octasphere(levels), [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return {x.x(), x.y(), 0.04 * x.z() + 0.3 * (x.x() * x.x() + x.y() * x.y())};
  });
}

}  // namespace greenloop::offline::test
