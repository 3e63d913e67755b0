#include "formats/transport/couplings_model.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t no_block = 0xffffffff;
constexpr std::uint32_t own_block = 0xfffffffe;  // of a coefficient with itself: not stored here, but large

// A block as it stands seen from a neighbour: itself or, times two plus one, its transpose.
constexpr std::uint32_t as_stored(std::uint32_t block) { return 2 * block; }
constexpr std::uint32_t transposed(std::uint32_t block) { return 2 * block + 1; }
constexpr bool is_stored(std::uint32_t seen) { return seen < own_block; }

constexpr std::uint32_t classes = 8;
constexpr std::uint32_t pairs = classes * classes;
constexpr std::uint32_t triples = classes * classes * classes;
constexpr std::uint32_t distances = 160;
constexpr std::uint32_t steps = 4;
constexpr std::uint32_t places = 9 * steps;
constexpr std::uint32_t some_rows = 1 << 14;

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

constexpr std::array<std::uint32_t, 6> presence_contexts{triples * steps, triples* steps, distances* classes* steps,
                                                         some_rows,       pairs* pairs,   64 * steps};
constexpr std::array<std::uint32_t, 1> layer_contexts{layout::layers};
constexpr std::array<std::uint32_t, 5> value_contexts{places * 64, places* size_steps* size_steps,
                                                      places* signed_classes* size_steps, places * 64 * 4,
                                                      places * 32 * size_steps};

}  // namespace

CouplingsModel::CouplingsModel()
    : lonely_presence_(std::size_t{distances} * steps),
      presence_(presence_contexts, classes * steps),
      coarse_(std::array<std::uint32_t, 2>{3, 64}, 1),
      layers_(layer_contexts, layout::layers, layout::layers),
      values_(value_contexts, places) {
  typical_error_.fill(4 * 256);
}

void CouplingsModel::code(BitCoder& coder, CouplingBlocks& couplings, std::span<const Coefficient> coefficients) {
  const std::vector<CouplingBlock> given = std::move(couplings.blocks);  // empty if this is a decoder's
  const std::vector<std::uint32_t> end = std::move(couplings.begin);
  const std::uint32_t first = couplings.rows - couplings.columns;
  components_ = couplings.components;
  begin_level(coefficients, first);
  couplings.begin = {0};
  couplings.blocks.clear();
  std::uint32_t next = 0;
  for (column_ = first; column_ < couplings.rows; ++column_) {
    begin_column();
    for (std::uint32_t row = 0; row < column_; ++row) {
      see_neighbours(row);
      const bool given_here = next < given.size() && next < end[column_ - first + 1] && given[next].row == row;
      if (!code_presence(coder, row, given_here)) continue;
      CouplingBlock block = given_here ? given[next++] : CouplingBlock{.row = row};
      code_block(coder, block);
      remember(block);
      couplings.blocks.push_back(block);
    }
    couplings.begin.push_back(static_cast<std::uint32_t>(couplings.blocks.size()));
  }
}

void CouplingsModel::begin_level(std::span<const Coefficient> coefficients, std::uint32_t first) {
  if (coefficients.size() < neighbours_.size()) throw DamagedPacket("fewer coefficients than on the levels before");
  coefficients_ = coefficients;
  std::vector<GridPoint> points;
  points.reserve(coefficients.size());
  for (const Coefficient& coefficient : coefficients) points.push_back(coefficient.point);
  neighbours_.resize(std::min(neighbours_.size(), std::size_t{first}));
  const auto more = neighbours_before(points, neighbours_.size());
  neighbours_.insert(neighbours_.end(), more.begin(), more.end());
  seen_from_.resize(coefficients.size());
  beside_.resize(coefficients.size());
  above_.resize(coefficients.size());
  row_predictors_.resize(3 * coefficients.size());
}

void CouplingsModel::begin_column() {
  Seen none;
  none.fill(no_block);
  std::fill(beside_.begin(), beside_.end(), none);
  std::fill(above_.begin(), above_.end(), no_block);
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    const std::uint32_t neighbour = neighbours_[column_][k];
    if (neighbour == no_neighbour) continue;
    for (const auto& [row, block] : seen_from_[neighbour]) beside_[row][k] = block;
    beside_[neighbour][k] = own_block;
  }
  column_predictors_.fill({});
}

void CouplingsModel::see_neighbours(std::uint32_t row) {
  constexpr std::array<std::uint32_t, neighbour_count> left_weight{6, 4, 2, 2, 0, 0, 1, 1},
      up_weight{3, 2, 1, 0, 0, 0, 1, 1};
  here_.step = std::min(coefficients_[column_].level - coefficients_[row].level, steps - 1);
  here_.distance = quarter_octave(squared_distance(coefficients_[column_].point, coefficients_[row].point));
  here_.left = beside_[row];
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    const std::uint32_t neighbour = neighbours_[row][k];
    here_.up[k] = neighbour == no_neighbour ? no_block : above_[neighbour];
  }
  std::uint32_t none = no_block;
  for (std::size_t k = 0; k < neighbour_count; ++k) none &= here_.left[k] & here_.up[k];
  here_.any = none != no_block;
  if (!here_.any) {
    here_.left_class.fill(0);
    here_.up_class.fill(0);
    here_.expected = 0;
    return;
  }
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    const std::uint32_t left = size(here_.left[k]), up = size(here_.up[k]);
    here_.left_class[k] = size_class(left);
    here_.up_class[k] = size_class(up);
    sum += left_weight[k] * left + up_weight[k] * up;
  }
  here_.expected = fine_class(sum / 4);
}

bool CouplingsModel::code_presence(BitCoder& coder, std::uint32_t row, bool present) {
  if (!here_.any) return lonely_presence_[here_.distance * steps + here_.step].code(coder, present);
  const auto& l = here_.left_class;
  const auto& u = here_.up_class;
  const std::array contexts{((l[0] * classes + l[1]) * classes + l[2]) * steps + here_.step,
                            ((u[0] * classes + u[1]) * classes + u[2]) * steps + here_.step,
                            (here_.distance * classes + l[0]) * steps + here_.step,
                            std::min(row, some_rows - 1),
                            (l[6] * classes + l[7]) * pairs + u[6] * classes + u[7],
                            here_.expected * steps + here_.step};
  return presence_.code(coder, present, contexts, l[0] * steps + here_.step);
}

void CouplingsModel::see_values() {
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    here_.left_values[k] = values(here_.left[k]);
    here_.up_values[k] = values(here_.up[k]);
  }
  here_.error = error_around();
}

void CouplingsModel::code_block(BitCoder& coder, CouplingBlock& block) {
  const auto coarse = [&](std::uint32_t seen) { return static_cast<std::uint32_t>(layer(seen) == 1); };
  const std::array contexts{coarse(here_.left[0]) + coarse(here_.up[0]), here_.expected};
  const bool is_coarse = coarse_.code(coder, block.layer == 0, contexts, 0);
  error_so_far_ = squares_so_far_ = 0;
  see_values();
  for (std::size_t element = 0; element < std::size_t{components_} * components_; ++element) {
    block.value[element] = static_cast<std::int16_t>(code_value(coder, block, element, block.value[element]));
  }
  if (is_coarse) {
    block.layer = 0;
  } else {
    code_layer(coder, block);
  }
}

std::int32_t CouplingsModel::code_value(BitCoder& coder, const CouplingBlock& block, std::size_t element,
                                        std::int32_t value_given) {
  const std::size_t n = components_, r = element % n, c = element / n, mirror = n * r + c;
  LinearPredictor<row_inputs>::Inputs up{};
  LinearPredictor<column_inputs>::Inputs left{};
  std::int64_t energy = 20;
  for (std::size_t k = 0; k < neighbour_count; ++k) {
    for (std::size_t d = 0; d < n; ++d) {
      up[3 * k + d] = here_.up_values[k][n * c + (r + d) % n];
      left[3 * k + d] = here_.left_values[k][n * ((c + d) % n) + r];
    }
  }
  for (std::size_t d = 0; d < r; ++d) up[3 * neighbour_count + d] = block.value[n * c + d];
  if (mirror < element) up[3 * neighbour_count + 3] = block.value[mirror];
  for (const std::int32_t input : up) energy += std::int64_t{input} * input;
  for (const std::int32_t input : left) energy += std::int64_t{input} * input;

  auto& row_predictor = row_predictors_[3 * std::size_t{block.row} + r];
  auto& column_predictor = column_predictors_[c];
  const std::int64_t exact = row_predictor.predict(up) + column_predictor.predict(left);
  const std::int64_t largest = largest_value(0);
  const std::int64_t rounded = std::clamp((exact + (exact < 0 ? -128 : 128)) / 256, -largest, largest);
  const auto fraction = static_cast<std::uint32_t>(std::clamp<std::int64_t>((exact - 256 * rounded + 128) / 64, 0, 3));

  const auto e = static_cast<std::uint32_t>(element);
  const std::uint32_t place = here_.step * 9 + e;
  const std::uint32_t in_block = (error_so_far_ + typical_error_[element]) / (e + 1);
  const std::uint32_t around = size_step(here_.error);
  const std::uint32_t squares = std::min(half_octave(squares_so_far_), 31U);
  const std::array contexts{
      place * 64 + fine_class((error_so_far_ + here_.error) / (e + 2) / 8),
      (place * size_steps + size_step(in_block)) * size_steps + around,
      (place * signed_classes + signed_class(exact)) * size_steps + around,
      (place * 64 + here_.expected) * 4 + fraction,
      (place * 32 + squares) * size_steps +
          size_step(static_cast<std::uint32_t>(std::min<std::int64_t>(std::abs(exact), 1 << 20)))};
  const auto error = static_cast<std::int32_t>(value_given - rounded);
  const std::int64_t coded = rounded + values_.code(coder, error, contexts, place);
  if (coded < -largest || coded > largest) throw DamagedPacket("a value that does not fit in any layer");

  const std::int64_t missed = 256 * coded - exact;
  const std::int64_t step = (missed << 16) / energy;
  row_predictor.learn(up, step / 2);
  column_predictor.learn(left, step / 10);
  const auto absolute = static_cast<std::uint32_t>(std::min<std::int64_t>(std::abs(missed), 1 << 22));
  error_so_far_ += absolute;
  squares_so_far_ = static_cast<std::uint32_t>(std::min<std::int64_t>(squares_so_far_ + coded * coded, 1 << 30));
  typical_error_[element] += absolute / 64 - typical_error_[element] / 64;
  return static_cast<std::int32_t>(coded);
}

// The layers that hold the values, from that of fewest bits on.
void CouplingsModel::code_layer(BitCoder& coder, CouplingBlock& block) {
  std::int32_t largest = 0;
  for (const std::int16_t element : block.value) largest = std::max<std::int32_t>(largest, std::abs(element));
  std::uint32_t layer = layout::layers - 1;
  while (layer > 1 && largest > largest_value(layer)) --layer;
  const std::uint32_t narrowest = layer;
  const std::array contexts{narrowest};
  while (layer > 1 && layers_.code(coder, block.layer != layer, contexts, narrowest, narrowest - layer)) --layer;
  block.layer = layer;
}

void CouplingsModel::remember(const CouplingBlock& block) {
  const auto index = static_cast<std::uint32_t>(blocks_.size());
  std::uint32_t sum = 0;
  for (const std::int16_t element : block.value) sum += static_cast<std::uint32_t>(std::abs(element));
  blocks_.push_back(block);
  sizes_.push_back(sum * 9 / (components_ * components_));
  errors_.push_back(error_so_far_ / (components_ * components_));
  above_[block.row] = as_stored(index);
  seen_from_[column_].emplace_back(block.row, as_stored(index));
  seen_from_[block.row].emplace_back(column_, transposed(index));
}

std::uint32_t CouplingsModel::size(std::uint32_t seen) const {
  return seen == no_block ? 0 : seen == own_block ? 60 : sizes_[seen / 2];
}

// 0: none
std::uint32_t CouplingsModel::layer(std::uint32_t seen) const {
  return seen == no_block ? 0 : seen == own_block ? 2 : 1 + blocks_[seen / 2].layer;
}

std::uint32_t CouplingsModel::error_around() const {
  constexpr std::array<std::uint32_t, 4> weights{4, 2, 1, 1};
  std::uint32_t sum = 0, weight = 0;
  for (const auto* side : {&here_.left, &here_.up}) {
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (!is_stored((*side)[k])) continue;
      sum += weights[k] * errors_[(*side)[k] / 2];
      weight += weights[k];
    }
  }
  return weight == 0 ? 256 : sum / weight;
}

std::array<std::int32_t, 9> CouplingsModel::values(std::uint32_t seen) const {
  std::array<std::int32_t, 9> values{};
  if (!is_stored(seen)) return values;
  const auto& stored = blocks_[seen / 2].value;
  const std::size_t n = components_;
  for (std::size_t k = 0; k < n * n; ++k) values[k] = stored[seen % 2 == 0 ? k : n * (k % n) + k / n];
  return values;
}

}  // namespace greenloop::transport
