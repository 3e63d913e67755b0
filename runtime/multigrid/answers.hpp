#pragma once

#include "runtime/multigrid.hpp"
#include "runtime/multigrid/elastic_body.hpp"

namespace greenloop {

// What is read off a state that was found. For the loop.

void copy_displacements(const ElasticBody& body, std::span<const std::uint32_t> chosen, std::span<Vec3> to) noexcept;

/// Work: shown vertices.
void copy_shown(const ElasticBody& body, std::span<Vec3> to) noexcept;

/// Von Mises stress of the measure's stress in the frame, mean around each vertex by volume. Work: tetrahedra.
void copy_stress(const ElasticBody& body, std::span<float> to) noexcept;

}  // namespace greenloop
