#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/wavelet/exact_columns.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// What predicts the domain nodes of each level in Equilibrated wavelets of fields with N numbers a node, 1 or 3
/// (docs/fields.md, "Thin bodies"), none on level 0: weights of NxN, from some of the nodes of the coarser level that
/// are nearest in space, such that the force pattern of a detail has neither a net force nor a net moment; of scalars,
/// that its sources cancel. Kriging with the exact compliance as covariance, U_mN U_NN^-1, and with a drift of large
/// variance: the six rigid motions, or the constant of scalars. Weights are whole multiples of layout::prediction_unit.
/// A node whose weights do not fit is predicted from the middle of its parents. linear: wavelets on the same domain.
/// Universal Kriging: Matheron 1969. columns: m/N. Reads those of all levels but the finest once. Memory: 25 kB a node
/// above level 0, 3 kB of scalars. Work: for each such node its distances to the coarser ones, and 6 updates of a
/// matrix of 19 N rows. Throws std::invalid_argument if columns are not finite or have not N rows a node. Offline only.
template <unsigned N>
[[nodiscard]] std::vector<PredictionsData> equilibrated_predictions(const SemiRegularMesh& mesh,
                                                                    const SurfaceWavelet& linear,
                                                                    const ExactColumns& columns);

/// Wavelets of any kind for an exact compliance of N numbers a node, 1 or 3, which only Equilibrated ones follow from.
/// flags, area [m^2]: one per node, as SurfaceWavelet has them. Throws as SurfaceWavelet and equilibrated_predictions
/// do. Offline only.
template <unsigned N>
[[nodiscard]] SurfaceWavelet make_wavelet(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                          const std::vector<double>& area, layout::Wavelet kind,
                                          const ExactColumns& columns);

}  // namespace greenloop::offline
