#pragma once

#include <cstddef>
#include <vector>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/search/encoding_search.hpp"
#include "offline/compress/search/frontier.hpp"
#include "offline/figures/column_form.hpp"
#include "offline/figures/exact_body.hpp"
#include "offline/figures/rate_curve.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// The compression of docs/compression.md, tried threshold by threshold: two-sided standard form, conditional scales,
/// quantised. Errors of the finest level on ExactSample::most_columns columns and figure_patches patches, of coarse
/// levels on LevelSample's. `body` must outlive it. Not copied or moved: parts refer to others. Offline only.
class TwoSidedForm {
 public:
  /// Streams the columns once and keeps what thresholds from `floor` on need.
  TwoSidedForm(const ExactBody& body, const WaveletKind& kind, double floor, const Progress& progress);
  TwoSidedForm(const TwoSidedForm&) = delete;
  TwoSidedForm& operator=(const TwoSidedForm&) = delete;

  /// Every constraint level's points, coarse to fine. `quantum`: of the values, relative to the threshold.
  [[nodiscard]] std::vector<LevelRates> rates(const std::vector<double>& thresholds, double quantum) const;

  /// The model at a threshold.
  [[nodiscard]] ModelData model(double threshold) const;

  [[nodiscard]] std::size_t rows() const { return wavelet_.rows(); }  ///< domain nodes

 private:
  [[nodiscard]] TrialBench bench() const { return {compliance_, tables_, sample_.columns(), {}, {}}; }

  SurfaceWavelet wavelet_;
  ExactSample sample_;
  WaveletCompliance<3> compliance_;
  ModelData tables_;
  ContactPatches patches_;
  std::vector<LevelSample> coarse_;
};

}  // namespace greenloop::offline
