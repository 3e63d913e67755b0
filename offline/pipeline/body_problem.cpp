#include "offline/pipeline/body_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "formats/layout.hpp"
#include "formats/mesh/volume_io.hpp"
#include "formats/output/json_text.hpp"
#include "offline/pipeline/stage_records.hpp"
#include "offline/scene/fingerprint.hpp"

namespace greenloop::offline {
namespace {

// what followed the body's text in the scenes that stores were first keyed with: the same for all, so that those fit
constexpr std::string_view other_keys = R"(
[constraints]
coarsest = 0

[accuracy]
rms = 0.02
worst_column = 0.1
patch_force = 0.05

[compression]
wavelet = "lifted linear"

[budget]
rate = "1000 Hz"
contacts = 16
)";

/// The columns that are wanted of a body, whatever they come from: in two-sided wavelet coordinates every row needs its
/// column.
GreenStoreContents describe_columns(BodyGeometry body) {
  GreenStoreContents contents;
  for (std::size_t i = 0; i < body.flags.size(); ++i) {
    if ((body.flags[i] & layout::node_domain) != 0) contents.row_node.push_back(static_cast<int>(i));
  }
  contents.column_node = contents.row_node;
  contents.surface = std::move(body.surface);
  contents.flags = std::move(body.flags);
  contents.area = std::move(body.area);
  return contents;
}

/// What finite elements make them of.
void add_finite_elements(const Scene& scene, Volume volume, GreenStoreContents& contents) {
  contents.volume = std::move(volume.mesh);
  contents.volume_fixed = std::move(volume.fixed);
  contents.interpolation.swap(volume.interpolation);
  contents.young = scene.material.young;
  contents.poisson = scene.material.poisson;
  contents.elements = scene.elements;
}

}  // namespace

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw std::runtime_error(fmt::format("{}: cannot be opened; does it exist?", path.string()));
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string mesh_bytes(const Scene& scene) {
  std::string bytes;
  for (const auto& file : files_of_mesh(scene.mesh.path)) {
    if (!bytes.empty()) bytes += '\0';
    bytes += read_file(file);
  }
  return bytes;
}

std::string column_fingerprint(const Scene& scene, const std::string& mesh) {
  const Fingerprint of_mesh = fingerprint(mesh, fingerprint(pipeline_version));
  return fingerprint(other_keys, fingerprint(body_text(scene), of_mesh)).hex();
}

std::size_t domain_size(const BodyGeometry& body) {
  return static_cast<std::size_t>(std::count_if(
      body.flags.begin(), body.flags.end(), [](std::uint32_t flags) { return (flags & layout::node_domain) != 0; }));
}

GreenStoreContents describe_problem(const Scene& scene, BodyGeometry body, const std::string& fingerprint,
                                    ProgressBar& progress) {
  nlohmann::json record = geometry_record(body.report);
  if (!body.volume) {
    auto filled = fill_with_tetrahedra(body, progress);
    record["volume"] = volume_record(filled);
    body.volume = std::move(filled.volume);
  }
  Volume volume = std::move(*body.volume);
  GreenStoreContents contents = describe_columns(std::move(body));
  add_finite_elements(scene, std::move(volume), contents);
  contents.provenance = json_text(record, -1);
  contents.fingerprint = fingerprint;
  return contents;
}

}  // namespace greenloop::offline
