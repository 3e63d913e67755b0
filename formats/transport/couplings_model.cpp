#include "formats/transport/couplings_model.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "formats/transport/linear_predictor.hpp"

namespace greenloop::transport {
namespace {

constexpr std::uint32_t no_block = 0xffffffff;
constexpr std::uint32_t own_block = 0xfffffffe;  // of a coefficient with itself: not stored here, but large

// A block as it stands seen from a neighbour: itself or, times two plus one, its transpose.
constexpr std::uint32_t as_stored(std::uint32_t block) { return 2 * block; }
constexpr std::uint32_t transposed(std::uint32_t block) { return 2 * block + 1; }

// 0: none; 1 .. 7 by the sum of magnitudes
std::uint32_t size_class(std::uint32_t size) {
  constexpr std::array<std::uint32_t, 6> limits{7, 9, 12, 16, 24, 48};
  if (size == 0) return 0;
  return 1 + static_cast<std::uint32_t>(std::lower_bound(limits.begin(), limits.end(), size) - limits.begin());
}

std::uint32_t fine_class(std::uint64_t size) { return std::min(quarter_octave(size), 63U); }

// 31 classes of a number in 1/256 by sign and size
constexpr std::uint32_t signed_classes = 31;
std::uint32_t signed_class(std::int64_t value) {
  const std::uint32_t size = std::min(half_octave(static_cast<std::uint64_t>(std::abs(value)) / 64), 15U);
  return value < 0 ? 15 - size : 15 + size;
}

// of an error in 1/256, two a doubling from 1/16 on
constexpr std::uint32_t size_steps = 24;
std::uint32_t size_step(std::uint32_t error) { return std::min(half_octave(error / 16), size_steps - 1); }

class CouplingsModel {
 public:
  CouplingsModel(BitCoder& coder, CouplingStatistics& statistics, CouplingBlocks& couplings,
                 std::span<const GridPoint> columns, std::span<const GridPoint> rows);
  void code();

 private:
  static constexpr std::size_t row_inputs = 3 * neighbour_count + 4;
  static constexpr std::size_t column_inputs = 3 * neighbour_count;

  void begin_column(std::uint32_t column);
  void see_neighbours(std::uint32_t row);
  bool code_presence(std::uint32_t row, bool present);
  void code_layer(std::uint32_t row, CouplingBlock& block);
  void code_values(std::uint32_t row, CouplingBlock& block);
  std::int32_t code_value(std::uint32_t row, const CouplingBlock& block, std::size_t element, std::int32_t value);
  void remember(std::uint32_t row, std::uint32_t block, const CouplingBlock& values);

  [[nodiscard]] std::uint32_t size(std::uint32_t seen) const;
  [[nodiscard]] std::uint32_t layer(std::uint32_t seen) const;  // 0: none
  [[nodiscard]] std::uint32_t error_around() const;
  [[nodiscard]] std::int32_t value(std::uint32_t seen, std::size_t element) const;

  BitCoder& coder_;
  CouplingBlocks& couplings_;
  std::span<const GridPoint> column_points_, row_points_;
  std::vector<Neighbours> column_neighbours_, row_neighbours_;
  std::vector<CouplingBlock> blocks_;  // those coded so far
  std::vector<std::uint32_t> sizes_;   // sums of magnitudes of their values
  std::vector<std::uint32_t> errors_;  // mean errors of the predictions of their values, in 1/256

  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> seen_from_;  // per column: row, block
  std::array<std::vector<std::uint32_t>, neighbour_count> beside_;               // per neighbour of the column: by row
  std::vector<std::uint32_t> above_;                                             // this column's, by row
  std::uint32_t column_ = 0;

  // about the block at hand: in neighbouring columns, at neighbouring rows
  std::array<std::uint32_t, neighbour_count> left_{}, up_{};
  std::array<std::uint32_t, 3> left_class_{}, up_class_{};
  std::uint32_t expected_ = 0;  // fine class of the size

  std::vector<LinearPredictor<row_inputs>> row_predictors_;        // [rows][3]
  std::vector<LinearPredictor<column_inputs>> column_predictors_;  // [3], of the column at hand
  std::array<std::uint32_t, 9> typical_error_;                     // of each element, in 1/256
  std::uint32_t error_so_far_ = 0;                                 // in this block, in 1/256
  std::uint32_t error_around_ = 0;                                 // of a value in neighbouring blocks, in 1/256

  MixedBits presence_;
  MixedBits layers_;
  MixedInteger& values_;
};

constexpr std::uint32_t classes = 8;
constexpr std::uint32_t distances = 160;

std::array<std::uint32_t, 4> presence_contexts(std::uint32_t rows) { return {512, 512, distances * classes, rows}; }
constexpr std::uint32_t layer_classes = layout::strengths + 1;
constexpr std::uint32_t layer_triples = layer_classes * layer_classes * layer_classes;
std::array<std::uint32_t, 4> layer_contexts(std::uint32_t rows) { return {layer_triples, layer_triples, 64, rows}; }
std::array<std::uint32_t, 4> value_contexts() {
  constexpr std::uint32_t places = 9 * layout::strengths;
  return {places * 64, places * size_steps * size_steps, places * signed_classes * size_steps, places * 64 * 4};
}

CouplingsModel::CouplingsModel(BitCoder& coder, CouplingStatistics& statistics, CouplingBlocks& couplings,
                               std::span<const GridPoint> columns, std::span<const GridPoint> rows)
    : coder_(coder),
      couplings_(couplings),
      column_points_(columns),
      row_points_(rows),
      column_neighbours_(neighbours_before(columns)),
      row_neighbours_(neighbours_before(rows)),
      seen_from_(columns.size()),
      above_(rows.size()),
      row_predictors_(3 * rows.size()),
      presence_(presence_contexts(couplings.rows), classes),
      layers_(layer_contexts(couplings.rows), 1, layout::strengths),
      values_(statistics.values) {
  for (auto& column : beside_) column.resize(rows.size());
  typical_error_.fill(4 * 256);
}

void CouplingsModel::code() {
  const std::vector<CouplingBlock> given = std::move(couplings_.blocks);  // empty if this is a decoder's
  const std::vector<std::uint32_t> end = std::move(couplings_.begin);
  couplings_.begin = {0};
  std::uint32_t next = 0;
  for (column_ = 0; column_ < couplings_.columns; ++column_) {
    begin_column(column_);
    const std::uint32_t rows = couplings_.triangular ? column_ : couplings_.rows;
    for (std::uint32_t row = 0; row < rows; ++row) {
      see_neighbours(row);
      const bool given_here = !given.empty() && next < end[column_ + 1] && given[next].row == row;
      if (!couplings_.dense && !code_presence(row, given_here)) continue;
      CouplingBlock block = given_here ? given[next++] : CouplingBlock{.row = row};
      if (!couplings_.dense) code_layer(row, block);
      code_values(row, block);
      remember(row, static_cast<std::uint32_t>(blocks_.size()), block);
    }
    couplings_.begin.push_back(static_cast<std::uint32_t>(blocks_.size()));
  }
  couplings_.blocks = std::move(blocks_);
}

void CouplingsModel::begin_column(std::uint32_t column) {
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    std::fill(beside_[k].begin(), beside_[k].end(), no_block);
    const std::uint32_t neighbour = column_neighbours_[column][k];
    if (neighbour == no_neighbour) continue;
    for (const auto& [row, block] : seen_from_[neighbour]) beside_[k][row] = block;
    if (couplings_.triangular) beside_[k][neighbour] = own_block;
  }
  std::fill(above_.begin(), above_.end(), no_block);
  column_predictors_.assign(3, {});
}

void CouplingsModel::see_neighbours(std::uint32_t row) {
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    const std::uint32_t neighbour = row_neighbours_[row][k];
    left_[k] = beside_[k][row];
    up_[k] = neighbour == no_neighbour ? no_block : above_[neighbour];
  }
  constexpr std::array<std::uint32_t, 4> left_weight{6, 4, 2, 2};
  constexpr std::array<std::uint32_t, 3> up_weight{3, 2, 1};
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < 4; ++k) sum += left_weight[k] * size(left_[k]);
  for (std::size_t k = 0; k < 3; ++k) {
    sum += up_weight[k] * size(up_[k]);
    left_class_[k] = size_class(size(left_[k]));
    up_class_[k] = size_class(size(up_[k]));
  }
  expected_ = fine_class(sum / 4);
}

bool CouplingsModel::code_presence(std::uint32_t row, bool present) {
  const auto [l0, l1, l2] = left_class_;
  const auto [u0, u1, u2] = up_class_;
  const std::uint32_t distance = quarter_octave(squared_distance(column_points_[column_], row_points_[row]));
  const std::array contexts{(l0 * classes + l1) * classes + l2, (u0 * classes + u1) * classes + u2,
                            distance * classes + l0, row};
  return presence_.code(coder_, present, contexts, l0);
}

void CouplingsModel::code_layer(std::uint32_t row, CouplingBlock& block) {
  const auto triple = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return (layer(a) * layer_classes + layer(b)) * layer_classes + layer(c);
  };
  const std::array contexts{triple(left_[0], left_[1], left_[2]), triple(up_[0], up_[1], left_[0]), expected_, row};
  std::uint32_t coded = 0;
  while (coded + 1 < couplings_.bits.size() && layers_.code(coder_, block.layer != coded, contexts, 0, coded)) ++coded;
  block.layer = coded;
}

void CouplingsModel::code_values(std::uint32_t row, CouplingBlock& block) {
  error_so_far_ = 0;
  error_around_ = error_around();
  for (std::size_t element = 0; element < 9; ++element) {
    block.value[element] = static_cast<std::int16_t>(code_value(row, block, element, block.value[element]));
  }
}

std::int32_t CouplingsModel::code_value(std::uint32_t row, const CouplingBlock& block, std::size_t element,
                                        std::int32_t value_given) {
  const std::size_t r = element % 3, c = element / 3, mirror = 3 * r + c;
  LinearPredictor<row_inputs>::Inputs up{};
  LinearPredictor<column_inputs>::Inputs left{};
  std::int64_t energy = 20;
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      up[3 * k + d] = value(up_[k], 3 * c + (r + d) % 3);
      left[3 * k + d] = value(left_[k], 3 * ((c + d) % 3) + r);
    }
  }
  for (std::size_t d = 0; d < r; ++d) up[3 * neighbour_count + d] = block.value[3 * c + d];
  if (mirror < element) up[3 * neighbour_count + 3] = block.value[mirror];
  for (const std::int32_t input : up) energy += std::int64_t{input} * input;
  for (const std::int32_t input : left) energy += std::int64_t{input} * input;

  auto& row_predictor = row_predictors_[3 * std::size_t{row} + r];
  auto& column_predictor = column_predictors_[c];
  const std::int64_t exact = row_predictor.predict(up) + column_predictor.predict(left);
  const std::int64_t largest = (std::int64_t{1} << (couplings_.bits[block.layer] - 1)) - 1;
  const std::int64_t rounded = std::clamp((exact + (exact < 0 ? -128 : 128)) / 256, -largest, largest);
  const auto fraction = static_cast<std::uint32_t>(std::clamp<std::int64_t>((exact - 256 * rounded + 128) / 64, 0, 3));

  const std::uint32_t place = block.layer * 9 + static_cast<std::uint32_t>(element);
  const auto e = static_cast<std::uint32_t>(element);
  const std::uint32_t in_block = (error_so_far_ + typical_error_[element]) / (e + 1);
  const std::uint32_t around = size_step(error_around_);
  const std::array contexts{place * 64 + fine_class((error_so_far_ + error_around_) / (e + 2) / 8),
                            (place * size_steps + size_step(in_block)) * size_steps + around,
                            (place * signed_classes + signed_class(exact)) * size_steps + around,
                            (place * 64 + expected_) * 4 + fraction};
  const auto error = static_cast<std::int32_t>(value_given - rounded);
  const std::int64_t coded = rounded + values_.code(coder_, error, contexts, place);
  if (coded < -largest || coded > largest) throw DamagedPacket("a value that does not fit in its layer");

  const std::int64_t missed = 256 * coded - exact;
  const std::int64_t step = (missed << 16) / energy;
  row_predictor.learn(up, step / 2);
  column_predictor.learn(left, step / 10);
  const auto absolute = static_cast<std::uint32_t>(std::min<std::int64_t>(std::abs(missed), 1 << 22));
  error_so_far_ += absolute;
  typical_error_[element] += absolute / 64 - typical_error_[element] / 64;
  return static_cast<std::int32_t>(coded);
}

void CouplingsModel::remember(std::uint32_t row, std::uint32_t block, const CouplingBlock& values) {
  std::uint32_t sum = 0;
  for (const std::int16_t element : values.value) sum += static_cast<std::uint32_t>(std::abs(element));
  blocks_.push_back(values);
  sizes_.push_back(sum);
  errors_.push_back(error_so_far_ / 9);
  above_[row] = as_stored(block);
  seen_from_[column_].emplace_back(row, as_stored(block));
  if (couplings_.triangular) seen_from_[row].emplace_back(column_, transposed(block));
}

std::uint32_t CouplingsModel::size(std::uint32_t seen) const {
  return seen == no_block ? 0 : seen == own_block ? 60 : sizes_[seen / 2];
}

std::uint32_t CouplingsModel::layer(std::uint32_t seen) const {
  return seen == no_block ? 0 : seen == own_block ? 1 : 1 + blocks_[seen / 2].layer;
}

std::uint32_t CouplingsModel::error_around() const {
  constexpr std::array<std::uint32_t, 4> weights{4, 2, 1, 1};
  std::uint32_t sum = 0, weight = 0;
  for (const auto* side : {&left_, &up_}) {
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if ((*side)[k] == no_block || (*side)[k] == own_block) continue;
      sum += weights[k] * errors_[(*side)[k] / 2];
      weight += weights[k];
    }
  }
  return weight == 0 ? 256 : sum / weight;
}

std::int32_t CouplingsModel::value(std::uint32_t seen, std::size_t element) const {
  if (seen == no_block || seen == own_block) return 0;
  return blocks_[seen / 2].value[seen % 2 == 0 ? element : 3 * (element % 3) + element / 3];
}

}  // namespace

CouplingStatistics::CouplingStatistics() : values(value_contexts(), 9 * layout::strengths) {}

void code_couplings(BitCoder& coder, CouplingStatistics& statistics, CouplingBlocks& couplings,
                    std::span<const GridPoint> columns, std::span<const GridPoint> rows) {
  CouplingsModel(coder, statistics, couplings, columns, rows).code();
}

}  // namespace greenloop::transport
