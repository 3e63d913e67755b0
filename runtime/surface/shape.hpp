#pragma once

#include <cstdint>
#include <span>

#include "runtime/surface/parts.hpp"

namespace greenloop {

/// What Surface::normals and Surface::areas write; sizes are right. For the loop; linear in the level's triangles.
void write_normals(const SurfaceParts& parts, std::uint32_t level, std::span<const Vec4> displacement,
                   std::span<Vec4> normal) noexcept;
void write_areas(const SurfaceParts& parts, std::uint32_t level, std::span<const Vec4> displacement,
                 std::span<float> area) noexcept;

}  // namespace greenloop
