#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/writer.hpp"
#include "runtime/algebra/fnv1a.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop {

/// A model in memory. Throws std::runtime_error if the bytes are refused.
class TestModel {
 public:
  explicit TestModel(const SyntheticOptions& options) : TestModel(encode(synthetic_model(options))) {}
  explicit TestModel(std::span<const std::byte> bytes);

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const ModelView& view() const { return model_.view(); }
  [[nodiscard]] std::vector<std::uint32_t> touchable() const { return touchable_nodes(view()); }

 private:
  AlignedBytes bytes_;
  Model model_;
};

/// A body of a TestModel, which must outlive it.
class TestBody : public Hosted<Elastostatic> {
 public:
  TestBody(const TestModel& model, const Elastostatic::Limits& limits) : Hosted(model.model(), limits) {}
};

/// The least budget with which a new body answers at the finest level, the whole field if any: what the step is planned
/// to take, at least what it reports.
[[nodiscard]] std::uint64_t least_budget_of_finest(const TestModel& model, const Elastostatic::Limits& limits,
                                                   std::span<const Constraint> contacts, bool with_field);

/// `count` touchable nodes from the `first` on, held at displacements that differ.
[[nodiscard]] std::vector<Constraint> patch(const TestModel& model, std::size_t first, std::size_t count);

/// A model whose couplings on the finest level are too strong for their scales: there, neighbours in the file have no
/// positive definite capacitance matrix.
[[nodiscard]] ModelData indefinite_model(const SyntheticOptions& options);

/// FNV-1a over the bytes, to be chained.
std::uint64_t hash_bytes(std::uint64_t hash, std::span<const std::byte> bytes);

/// Chains the whole of a step's outcome.
std::uint64_t hash_step(std::uint64_t hash, const Elastostatic::StepReport& report, std::span<const float> force,
                        std::span<const float> field);

inline constexpr std::uint64_t empty_hash = Fnv1a{}.value();

}  // namespace greenloop
