#pragma once

// What a section holds besides couplings: arrays of records of 32-bit words, coded as differences from what they can be
// predicted from, and bytes of any kind.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/layout.hpp"
#include "formats/transport/adaptive_integer.hpp"
#include "formats/transport/couplings_model.hpp"
#include "formats/transport/neighbours.hpp"

namespace greenloop::transport {

/// Bytes of any kind, from the two before each.
class ByteModel {
 public:
  ByteModel();
  /// An encoder codes `bytes`, a decoder fills them.
  void code(BitCoder& coder, std::span<std::byte> bytes);

 private:
  MixedBits bits_;
};

/// Words of records with `fields` words each, by their difference from a prediction in the order of floating-point
/// numbers, which is also that of integers.
class WordModel {
 public:
  explicit WordModel(std::uint32_t fields);
  std::uint32_t code(BitCoder& coder, std::uint32_t field, std::uint32_t word, std::uint32_t predicted);

  /// The same for floating-point numbers that are whole numbers of 2^(step - 150), differences in these steps.
  std::uint32_t code_steps(BitCoder& coder, std::uint32_t field, std::uint32_t step, std::uint32_t word,
                           std::uint32_t predicted);

 private:
  std::int64_t code_difference(BitCoder& coder, std::uint32_t field, std::int64_t difference);

  AdaptiveInteger differences_;
  std::vector<std::uint32_t> length_;  // of the last difference, by fields
};

/// The mesh as far as sections have told it, and the sections that tell it. A decoder's sections may say anything:
/// nothing here relies on their being right.
class MeshModel {
 public:
  /// Refinement(q): parents and lifting weights from the record before.
  void code_refinement(BitCoder& coder, std::uint32_t q, std::span<std::byte> section);

  /// Nodes(q): positions from the middle of the parents, if there are any, else from the node before. After
  /// Refinement(q).
  void code_nodes(BitCoder& coder, std::uint32_t q, std::span<std::byte> section);

  /// Representatives(c, q): from the node itself and its parents. After Nodes(q).
  void code_representatives(BitCoder& coder, std::uint32_t c, std::uint32_t q, std::span<std::byte> section);

  /// Scales(q): from the nearest coefficient before, in steps of the last digit if all of a field's numbers have it.
  /// After Nodes(q).
  void code_scales(BitCoder& coder, std::uint32_t q, std::uint32_t components, std::span<std::byte> section);

  /// BaseTriangles and the like: words from those `fields` before.
  void code_words(BitCoder& coder, std::uint32_t fields, std::span<std::byte> section);

  /// The coefficients of levels 0 .. q, and how many of them are of level q.
  [[nodiscard]] std::vector<Coefficient> coefficients(std::uint32_t q) const;
  [[nodiscard]] std::uint32_t own_coefficients(std::uint32_t q) const;

 private:
  struct Node {
    std::array<std::uint32_t, 3> position{};  // bits
    std::uint32_t flags = 0;
    std::array<std::uint32_t, 2> parent{layout::none, layout::none};  // file indices
  };
  [[nodiscard]] std::uint32_t largest_exponent() const;
  [[nodiscard]] std::array<std::uint32_t, 3> predicted_position(std::size_t node, std::uint32_t exponent) const;
  [[nodiscard]] std::vector<std::size_t> domain_nodes(std::uint32_t q) const;
  [[nodiscard]] static GridPoint grid_point(const Node& node, std::uint32_t exponent);
  [[nodiscard]] std::uint32_t representative(std::uint32_t c, std::uint32_t node) const;

  std::vector<Node> nodes_;                                                       // by file index
  std::array<std::size_t, layout::max_levels + 1> begin_{};                       // of each level
  std::array<std::vector<std::uint32_t>, layout::max_levels> representatives_{};  // [c][file index]
};

}  // namespace greenloop::transport
