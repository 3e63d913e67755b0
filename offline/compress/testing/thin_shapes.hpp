#pragma once

#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop::offline::test {

// Closed bodies with thin parts whose edges are round, as people model them: an ear, a shell, a handle, a web. All have
// subdivision connectivity; the first, second and fourth 12, 42, 162, 642, 2562, ... vertices, the third 40, 160, ...

/// A ball of radius 1 drawn out upwards, along z, to a blade: 2.2 m tall, 1.2 m wide and 16 cm thick, across x.
[[nodiscard]] SemiRegularMesh ear(int levels);

/// A bowl, open upwards, 2 m across, 8 cm thick and 30 cm deep.
[[nodiscard]] SemiRegularMesh bowl(int levels);

/// A mug without its hollow: a ball of radius 70 cm around (-1 m, 0, 0) that ends in a ring around y, the handle, at
/// most 16 cm thick and 40 cm wide.
[[nodiscard]] SemiRegularMesh handle(int levels);

/// A 2 m long piece, along x, of thick ends, 40 cm across, and a web of 6 cm and 1.2 m width, 1 m long, between them: 3
/// mm if the piece is scaled to 10 cm.
[[nodiscard]] SemiRegularMesh web(int levels);

}  // namespace greenloop::offline::test
