#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "formats/layout.hpp"

namespace greenloop {

/// Couplings of one level and layer before encoding; see layout::CouplingsHeader.
struct CouplingsData {
  std::vector<std::uint32_t> begin;  ///< columns + 1
  std::vector<std::uint32_t> index;  ///< rows; stored in 2 bytes where they fit
  std::vector<std::int16_t> value;   ///< N x N per block, by columns; N: the model's components
};

/// Predictions of one level before encoding; see layout::PredictionsHeader.
struct PredictionsData {
  std::uint32_t terms = 0;           ///< of every domain node
  std::vector<std::uint32_t> index;  ///< [domain nodes * terms]
  std::vector<std::int16_t> weight;  ///< N x N per term, by columns
};

/// Scales of one level before encoding: layout::Scale<N> of each domain node, N: the model's components.
struct ScalesData {
  std::vector<float> numbers;  ///< [domain nodes * N (N + 1)]

  template <unsigned N>
  [[nodiscard]] std::span<layout::Scale<N>> of() {
    return {reinterpret_cast<layout::Scale<N>*>(numbers.data()), numbers.size() / (std::size_t{N} * (N + 1))};
  }
  template <unsigned N>
  [[nodiscard]] std::span<const layout::Scale<N>> of() const {
    return {reinterpret_cast<const layout::Scale<N>*>(numbers.data()), numbers.size() / (std::size_t{N} * (N + 1))};
  }
  template <unsigned N>
  void push_back(const layout::Scale<N>& scale) {
    numbers.insert(numbers.end(), std::begin(scale.root), std::end(scale.root));
    numbers.insert(numbers.end(), std::begin(scale.diagonal), std::end(scale.diagonal));
  }
};

/// One level of a model before encoding.
struct LevelData {
  layout::Level counts{};
  std::vector<layout::NodeRecord> nodes;
  std::vector<layout::RefinementRecord> refinement;  ///< empty on level 0
  std::vector<layout::StencilRecord> stencils;  ///< [domain nodes]; empty on level 0 and without Butterfly wavelets
  PredictionsData predictions;                  ///< empty on level 0 and without Equilibrated wavelets
  /// [mesh level][node in that level], every mesh level; empty below the coarsest constraint level
  std::vector<std::vector<std::uint32_t>> representatives;
  ScalesData scales;  ///< [domain nodes]
  std::array<CouplingsData, layout::layers> couplings;
  std::vector<layout::PatternRecord> patterns;  ///< by kind, then contacts; empty below the coarsest constraint level
  std::vector<float> load_columns;              ///< m a unit, [loads][domain nodes][3]
};

/// A whole model before encoding. Offline only.
struct ModelData {
  layout::Info info{};
  std::string provenance;
  std::vector<std::uint32_t> base_triangles;
  std::vector<LevelData> levels;
  std::vector<layout::VertexRecord> vertices;  ///< of the author's surface; empty: no VertexMap
  std::vector<layout::LoadRecord> loads;       ///< accelerations along x, y and z or none of them, then pressures
};

/// The bytes of a model file: deterministic, complete, checksummed; of Info::components 1 or 3. Throws
/// std::invalid_argument naming the field that does not fit. Filled in from the vectors, whatever stands there:
/// Info::levels, finest_constraint_level, loads and the box; Level's node, domain, triangle, kept and dense counts. The
/// result has passed verify.
[[nodiscard]] std::vector<std::byte> encode(const ModelData& model);

/// The form of one section of couplings.
struct CouplingsForm {
  std::uint32_t components;  ///< N: 1 or 3
  std::uint32_t columns;     ///< of the level, even if there is no block
  std::uint32_t rows;        ///< domain nodes of K(q)
  std::uint32_t value_bits;  ///< the layer's
};

/// Its bytes, without its entry. `name` stands in messages. Throws std::invalid_argument naming the field that does not
/// fit.
[[nodiscard]] std::vector<std::byte> encode_couplings(const CouplingsData& data, const CouplingsForm& form,
                                                      const std::string& name);

/// The same model cut off after level q: a prefix with its header rewritten. Throws std::invalid_argument if q is not
/// a level of the file or no constraint level at or below q has columns.
[[nodiscard]] std::vector<std::byte> truncate_to_level(std::vector<std::byte> model, std::uint32_t q);

}  // namespace greenloop
