#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "offline/compress/linear_wavelet.hpp"

namespace greenloop::offline {

inline constexpr std::uint32_t all_layers = 3;  ///< of couplings, by layout::Strength

/// The compliance that a model file stands for, in double precision: what the loop's answers are measured with and
/// certified on. Non-standard form, see formats/layout.hpp. Offline only.
class CompressedCompliance {
 public:
  /// `layers`: how many layers of couplings count, strong ones first; 3: all. The view must outlive this object.
  /// Memory: about 80 bytes per coupling.
  CompressedCompliance(const ModelView& view, std::uint32_t layers);

  [[nodiscard]] std::size_t finest() const { return wavelet_.finest(); }
  [[nodiscard]] std::size_t rows(std::size_t level) const { return wavelet_.row_end(level); }  ///< domain nodes of K
  [[nodiscard]] const LinearWavelet& wavelet() const { return wavelet_; }

  /// x = U^_level f: `columns` displacement fields (m) for as many force patterns (N) on the averages of `level` (on
  /// the nodes, if it is the finest). f, x: rows(level) * columns * 3 numbers, by row, then by column. Zero forces are
  /// skipped. Work: 9 * columns per coupling of coefficients that feel a force.
  void apply(std::size_t level, std::size_t columns, const double* f, double* x) const;

  /// Block column j of U^_level: rows(level) blocks of 9 numbers, 3 c + r.
  [[nodiscard]] std::vector<double> column(std::size_t level, std::size_t j) const;

 private:
  struct Link {
    std::uint32_t other;
    std::uint32_t block;
    bool transposed;
  };
  // averages of a level that are partners of finer details: their own coefficients after those of the domain rows
  struct Role {
    std::size_t begin = 0;
    std::size_t count = 0;
  };

  void number_coefficients(const ModelView& view);
  void load_couplings(const ModelView& view, std::uint32_t layers);
  void link(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& ends);

  LinearWavelet wavelet_;
  std::vector<Role> averages_;              // [level], empty for level 0 (whose averages are domain rows)
  std::vector<std::uint32_t> needs_level_;  // [coefficient] it takes part from this level on
  std::vector<float> root_, diagonal_;      // [coefficient] 9 numbers
  std::vector<float> block_;                // [coupling] 9 numbers
  std::vector<std::size_t> link_begin_;     // [coefficient + 1]
  std::vector<Link> links_;
};

}  // namespace greenloop::offline
