#include "offline/compress/encode/model_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "offline/compress/encode/representatives.hpp"

namespace greenloop::offline {
namespace {

std::vector<layout::NodeRecord> node_records(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                             const std::vector<double>& area, std::size_t begin, std::size_t end) {
  std::vector<layout::NodeRecord> records;
  for (std::size_t node = begin; node < end; ++node) {
    const Eigen::Vector3f position = mesh.positions[node].cast<float>();
    std::uint32_t flag = flags[node];
    if ((flag & layout::node_fixed) != 0) flag &= ~std::uint32_t{layout::node_touchable};  // it cannot be a contact
    records.push_back({{position.x(), position.y(), position.z()}, static_cast<float>(area[node]), flag});
  }
  return records;
}

std::vector<layout::RefinementRecord> refinement_records(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet,
                                                         std::size_t level) {
  std::vector<layout::RefinementRecord> records;
  for (std::size_t node = mesh.vertex_end[level - 1]; node < mesh.vertex_end[level]; ++node) {
    const auto [a, b] = mesh.parents[node];
    records.push_back({{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)}, {0.0F, 0.0F}});
  }
  for (const auto& odd : wavelet.odds(level)) {
    std::copy_n(odd.lift, 2, records[wavelet.nodes()[odd.row] - mesh.vertex_end[level - 1]].lift);
  }
  return records;
}

}  // namespace

ModelData describe_mesh(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                        const std::vector<double>& area, const SurfaceWavelet& wavelet, layout::Problem problem,
                        const layout::Info& facts) {
  ModelData model;
  model.info = facts;
  model.info.problem = static_cast<std::uint32_t>(problem);
  model.info.wavelet = static_cast<std::uint32_t>(wavelet.kind());
  model.info.components = layout::components_of(problem);
  for (const auto& triangle : mesh.base_triangles) {
    for (const int corner : triangle) model.base_triangles.push_back(static_cast<std::uint32_t>(corner));
  }
  for (std::size_t q = 0; q <= wavelet.finest(); ++q) {
    LevelData level;
    level.nodes = node_records(mesh, flags, area, q == 0 ? 0 : mesh.vertex_end[q - 1], mesh.vertex_end[q]);
    if (q > 0) {
      level.refinement = refinement_records(mesh, wavelet, q);
      const auto stencils = wavelet.stencils(q);
      level.stencils.assign(stencils.begin(), stencils.end());
      level.predictions = wavelet.predictions(q);
    }
    model.levels.push_back(std::move(level));
  }
  return model;
}

void add_representatives(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, ModelData& model) {
  const std::uint32_t asked = model.info.coarsest_constraint_level;
  std::uint32_t& coarsest = model.info.coarsest_constraint_level;
  for (std::uint32_t level = asked; level < model.levels.size(); ++level) {
    const auto all = representatives(mesh, flags, level);
    if (std::all_of(all.begin(), all.end(), [](std::uint32_t r) { return r == layout::none; })) {
      coarsest = level + 1;
      continue;
    }
    std::size_t begin = 0;
    for (const std::size_t end : mesh.vertex_end) {
      model.levels[level].representatives.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                       all.begin() + static_cast<std::ptrdiff_t>(end));
      begin = end;
    }
  }
  if (coarsest >= model.levels.size()) {
    throw std::invalid_argument("compression: no node is both free and touchable on constraint level " +
                                std::to_string(asked) + " or finer");
  }
}

}  // namespace greenloop::offline
