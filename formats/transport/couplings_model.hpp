#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "formats/transport/adaptive_integer.hpp"
#include "formats/transport/coupling_blocks.hpp"
#include "formats/transport/linear_predictor.hpp"
#include "formats/transport/neighbours.hpp"
#include "formats/transport/range_coder.hpp"

namespace greenloop::transport {

/// What is known of a coefficient before its couplings.
struct Coefficient {
  GridPoint point{};
  std::uint32_t level = 0;
};

/// Codes couplings level by level. Whether a block is stored, its values, nine or one, and its layer are predicted from
/// the blocks of neighbouring columns and rows coded before, on this level and coarser ones.
class CouplingsModel {
 public:
  CouplingsModel();

  /// Codes `begin` and `blocks` of `couplings`, always of the same components; what else it says both sides know.
  /// `coefficients`: of all its rows; those of the levels before as they were. A decoder throws DamagedPacket if it
  /// reads what no encoder writes. Work: columns times rows, and some hundred operations a value.
  void code(BitCoder& coder, CouplingBlocks& couplings, std::span<const Coefficient> coefficients);

 private:
  static constexpr std::size_t row_inputs = 3 * neighbour_count + 4;
  static constexpr std::size_t column_inputs = 3 * neighbour_count;
  using Seen = std::array<std::uint32_t, neighbour_count>;

  // about the block at hand
  struct Surroundings {
    Seen left{}, up{};  // the blocks in neighbouring columns and at neighbouring rows
    std::array<std::uint32_t, neighbour_count> left_class{}, up_class{};
    bool any = false;            // whether there are any
    std::uint32_t step = 0;      // levels from the row to the column
    std::uint32_t expected = 0;  // fine class of the size
    std::uint32_t distance = 0;  // class of that between row and column
    std::uint32_t error = 0;     // of a value in neighbouring blocks, in 1/256
    std::array<std::array<std::int32_t, 9>, neighbour_count> left_values{}, up_values{};
  };

  void begin_level(std::span<const Coefficient> coefficients, std::uint32_t first);
  void begin_column();
  void see_neighbours(std::uint32_t row);
  bool code_presence(BitCoder& coder, std::uint32_t row, bool present);
  void see_values();
  void code_block(BitCoder& coder, CouplingBlock& block);
  std::int32_t code_value(BitCoder& coder, const CouplingBlock& block, std::size_t element, std::int32_t value);
  void code_layer(BitCoder& coder, CouplingBlock& block);
  void remember(const CouplingBlock& block);

  [[nodiscard]] std::uint32_t size(std::uint32_t seen) const;
  [[nodiscard]] std::uint32_t layer(std::uint32_t seen) const;
  [[nodiscard]] std::uint32_t error_around() const;
  [[nodiscard]] std::array<std::int32_t, 9> values(std::uint32_t seen) const;

  std::uint32_t components_ = 3;
  std::span<const Coefficient> coefficients_;
  std::vector<Neighbours> neighbours_;  // of all coefficients
  std::vector<CouplingBlock> blocks_;   // coded so far, of all levels
  std::vector<std::uint32_t> sizes_;    // sums of magnitudes of their values, as of nine
  std::vector<std::uint32_t> errors_;   // mean errors of the predictions of their values, in 1/256

  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> seen_from_;  // per coefficient: row, block
  std::vector<Seen> beside_;                                                     // by row: in neighbouring columns
  std::vector<std::uint32_t> above_;                                             // by row: in this column
  std::uint32_t column_ = 0;
  Surroundings here_;

  std::vector<LinearPredictor<row_inputs>> row_predictors_;          // [rows][3]
  std::array<LinearPredictor<column_inputs>, 3> column_predictors_;  // of the column at hand
  std::array<std::uint32_t, 9> typical_error_;                       // of each element, in 1/256
  std::uint32_t error_so_far_ = 0;                                   // in this block, in 1/256
  std::uint32_t squares_so_far_ = 0;                                 // of its values

  std::vector<AdaptiveBit> lonely_presence_;  // of blocks without neighbours: [distance][step]
  MixedBits presence_, coarse_, layers_;
  MixedInteger values_;
};

}  // namespace greenloop::transport
