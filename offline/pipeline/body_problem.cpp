#include "offline/pipeline/body_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "formats/layout.hpp"
#include "offline/scene/fingerprint.hpp"

namespace greenloop::offline {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw std::runtime_error(fmt::format("{}: cannot be opened; does it exist?", path.string()));
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string column_fingerprint(Scene scene, const std::string& mesh) {
  scene.mesh.keep_vertex_map = false;
  scene.coarsest_constraints = 0;
  scene.accuracy = {};
  // not in the text: stores from before these goals still fit
  scene.accuracy.field = scene.accuracy.field_peak = scene.accuracy.field_rough = 0;
  scene.wavelet = layout::Wavelet::lifted_linear;
  scene.budget = {};
  scene.store.reset();
  scene.store_name.clear();
  return fingerprint(canonical_text(scene), fingerprint(mesh, fingerprint(pipeline_version))).hex();
}

std::size_t domain_size(const BodyGeometry& body) {
  return static_cast<std::size_t>(std::count_if(
      body.flags.begin(), body.flags.end(), [](std::uint32_t flags) { return (flags & layout::node_domain) != 0; }));
}

GreenStoreContents describe_problem(const Scene& scene, BodyGeometry body, const std::string& fingerprint,
                                    ProgressBar& progress) {
  nlohmann::json record = body.record;
  auto volume = body.volume ? std::move(*body.volume) : fill_with_tetrahedra(body, progress, record);
  GreenStoreContents contents;
  contents.surface = std::move(body.surface);
  contents.area = Eigen::VectorXd::Map(body.area.data(), static_cast<Eigen::Index>(body.area.size()));
  for (std::size_t i = 0; i < body.flags.size(); ++i) {
    const auto flags = body.flags[i];
    contents.flags.push_back(static_cast<std::uint8_t>(flags));
    // the compliance is kept in two-sided wavelet coordinates: every row needs its column
    if ((flags & layout::node_domain) != 0) {
      contents.row_node.push_back(static_cast<int>(i));
      contents.column_node.push_back(static_cast<int>(i));
    }
  }
  contents.volume = std::move(volume.mesh);
  contents.volume_fixed = std::move(volume.fixed);
  contents.interpolation.swap(volume.interpolation);
  contents.young = scene.material.young;
  contents.poisson = scene.material.poisson;
  contents.provenance = record.dump();
  contents.fingerprint = fingerprint;
  return contents;
}

}  // namespace greenloop::offline
