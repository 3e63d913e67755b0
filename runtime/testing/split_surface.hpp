#pragma once

#include <stdexcept>
#include <vector>

#include "runtime/algebra/double3.hpp"
#include "runtime/finer_surface.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {

/// The surface of a synthetic model at one of its levels, split further, in memory of its own.
class SplitSurface {
 public:
  SplitSurface(const TestModel& model, std::uint32_t level, const FinerSurface::Options& options)
      : surface_memory_(Surface::required(model.model(), level).bytes) {
    const auto made = Surface::create(model.model(), level, {surface_memory_.data(), surface_memory_.size()});
    if (!made) throw std::runtime_error("no surface");
    surface = made.surface;
    finer_memory_ = AlignedBytes(FinerSurface::required(surface, options));
    const auto split = FinerSurface::create(surface, options, {finer_memory_.data(), finer_memory_.size()});
    if (!split) throw std::runtime_error("no finer surface");
    finer = split.surface;
  }

  /// Of added level k.
  [[nodiscard]] std::vector<Vec4> positions(std::uint32_t k, std::span<const Vec4> displacement = {}) const {
    std::vector<Vec4> position(finer.vertex_count(k));
    if (!finer.positions(k, displacement, position)) throw std::runtime_error("no positions");
    return position;
  }

  Surface surface;
  FinerSurface finer;

 private:
  AlignedBytes surface_memory_, finer_memory_;
};

inline Double3 exact(const Vec4& v) { return {v.x, v.y, v.z}; }

}  // namespace greenloop
