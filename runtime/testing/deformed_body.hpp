#pragma once

#include <cstdint>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/contact/deformed_surface.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {

/// A synthetic sphere of radius 0.1 m, made `thickness` times as thick along x: a sheet with a sharp rim, such as an
/// ear.
[[nodiscard]] inline std::vector<std::byte> flattened_model(const SyntheticOptions& options, float thickness) {
  ModelData data = synthetic_model(options);
  for (LevelData& level : data.levels) {
    for (layout::NodeRecord& node : level.nodes) node.position[0] *= thickness;
  }
  return encode(data);
}

/// The surface of a model's finest level and a displacement of it, in memory of its own. Throws std::runtime_error.
class DeformedBody {
 public:
  explicit DeformedBody(const Model& model) {
    const std::uint32_t finest = model.level_count() - 1;
    surface_memory_ = AlignedBytes(Surface::required(model, finest).bytes);
    const auto at_rest = Surface::create(model, finest, {surface_memory_.data(), surface_memory_.size()});
    if (!at_rest) throw std::runtime_error("no surface of this model");
    deformed_memory_ = AlignedBytes(DeformedSurface::required(at_rest.surface));
    const auto created = DeformedSurface::create(at_rest.surface, {deformed_memory_.data(), deformed_memory_.size()});
    if (!created) throw std::runtime_error("no deformed surface of this model");
    surface = created.surface;
    displacement.resize(surface.node_count());
  }
  explicit DeformedBody(const SyntheticOptions& options, float thickness = 1)
      : DeformedBody(TestModel(flattened_model(options, thickness)).model()) {}

  /// Displaces the surface by what stands in `displacement`.
  void update() {
    std::uint64_t work = 0;
    if (!surface.update(displacement, work)) throw std::runtime_error("too few displacements");
  }

  DeformedSurface surface;
  std::vector<Vec4> displacement;

 private:
  AlignedBytes surface_memory_, deformed_memory_;
};

/// A sheet, 2 mm thick in its middle, sharp at its rim.
inline DeformedBody thin_ear(std::uint32_t levels = 4) { return DeformedBody({.levels = levels}, 0.01F); }

}  // namespace greenloop
