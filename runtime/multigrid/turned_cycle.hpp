#pragma once

#include "runtime/multigrid/elastic_body.hpp"

namespace greenloop {

/// Mean rotation of the tetrahedra around each free vertex, by their mass. For the loop; work: groups and vertices.
void turn_vertices(ElasticBody& body) noexcept;

/// z = about the solution of (operator of the turned body) z = r, z and r [vertices]: a cycle of the body at rest, to
/// which forces are turned back and whose displacements are turned forwards; held vertices take no part. Symmetric and
/// positive definite. For the loop; work: iteration_work's share.
void turned_cycle(ElasticBody& body, const Float4* r, Float4* z) noexcept;

}  // namespace greenloop
