#pragma once

#include <string_view>
#include <vector>

#include "formats/layout.hpp"
#include "offline/figures/exact_body.hpp"
#include "offline/figures/rate_curve.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// A wavelet that figures are made for.
struct WaveletKind {
  std::string_view name;
  layout::Wavelet wavelet = layout::Wavelet::linear;
};
inline constexpr WaveletKind wavelet_kinds[] = {{"linear", layout::Wavelet::linear},
                                                {"butterfly", layout::Wavelet::butterfly},
                                                {"lifted butterfly", layout::Wavelet::lifted_butterfly},
                                                {"lifted linear", layout::Wavelet::lifted_linear}};

/// Patches that forces are measured on.
inline constexpr std::size_t figure_patches = 32;

/// The compression of James & Pai 2003, section 4.5, with its errors (section 10.2.1) at each threshold epsilon, on
/// every constraint level, coarse to fine. Each Green's function, in traction form, is transformed by itself; block i
/// of level l >= 1 is dropped if its Frobenius norm is below 2^(l - L) epsilon times the largest block of the
/// untransformed column; base level blocks stay. Coarser levels have the Green's functions of that level's scaling
/// functions (section 6). Patch forces are those of the symmetric part of the finest level's compliance. Streams the
/// columns once; memory: the coarse levels' columns in single precision, a third of the dense matrix. Offline only.
[[nodiscard]] std::vector<LevelRates> column_form_rates(const ExactBody& body, const WaveletKind& kind,
                                                        const std::vector<double>& thresholds,
                                                        const Progress& progress);

}  // namespace greenloop::offline
