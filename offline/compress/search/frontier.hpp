#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/search/encoding_search.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/compress/wavelet/wavelet_compliance.hpp"

namespace greenloop::offline {

/// Patches and columns of the exact compliance of a coarse constraint level, to measure encodings with.
struct LevelSample {
  static constexpr std::size_t most_patches = 16;
  static constexpr std::size_t most_columns = 64;  ///< evenly spaced

  std::size_t level = 0;
  ContactPatches patches;
  std::vector<SampleColumn> columns;
};

/// Samples of the constraint levels from `coarsest` up to, not including, the finest. Work: at most 1088 times
/// exact_column per level.
[[nodiscard]] std::vector<LevelSample> sample_levels(const SemiRegularMesh& mesh, const SurfaceWavelet& wavelet,
                                                     const WaveletCompliance<3>& exact, std::size_t coarsest);

/// Bytes, blocks and, unless `work` is empty, work of an encoded model cut off after each constraint level; errors 0.
/// Encodes nothing.
[[nodiscard]] std::vector<LevelTrial> level_costs(const ModelFile& model, const LevelWork& work);

/// Adds thresholds at powers of two of the chosen one, from half of it to 16 times as much, where nothing near was
/// tried yet and the couplings at hand reach: at most five, to be tried by measure_frontier.
void fill_gaps(double chosen, double floor, std::vector<Trial>& trials);

/// Leaves out trials whose thresholds are within a tenth of the chosen one or of another that stays: the end of a
/// bisection, which tells nothing new.
void leave_out_near(double chosen, std::vector<Trial>& trials);

/// What was tried, by decreasing threshold, one trial each (the latest), on every constraint level: errors of coarse
/// levels on the samples, those of the finest as tried. Trials of 0 bytes are tried with `patches`; those that have
/// their levels already stay as they are. Work: an encoding and the samples' columns per threshold.
[[nodiscard]] std::vector<Trial> measure_frontier(const TrialBench& bench, const ContactPatches& patches,
                                                  const std::vector<LevelSample>& samples,
                                                  const std::vector<Trial>& trials);

}  // namespace greenloop::offline
