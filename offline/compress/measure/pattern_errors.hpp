#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/layout.hpp"
#include "formats/view.hpp"
#include "offline/compress/encode/compressed_compliance.hpp"
#include "offline/compress/measure/exact_contacts.hpp"

namespace greenloop::offline {

/// Median, 95th percentile and worst of some samples: of n the smallest that n / 2, 0.95 n and all of them do not
/// exceed.
struct Quantiles {
  double median = 0, p95 = 0, worst = 0;
};
/// `values` is not empty.
[[nodiscard]] Quantiles quantiles(std::vector<double> values);

/// The relative errors of a model's answer to some contacts. Infinite if its compliance is not positive definite there.
struct AnswerError {
  layout::PatternKind kind{};
  std::uint32_t contacts = 0;
  double field = 0;  ///< ||u^ - u|| / ||u||: L2, each node that is read weighted by its area
  double peak = 0;   ///< largest |u^_i - u_i| of the nodes that are read over the largest |u_i| of any domain node
  double force = 0;  ///< ||f^ - f|| / ||f|| of the nodal forces
  double total_force = 0;  ///< sum_g |F^_g - F_g| / sum_g |F_g| over the groups; 0 if the kind has none
};

/// The errors of all patterns of a kind and a number of contacts.
struct PatternErrors {
  layout::PatternKind kind{};
  std::uint32_t contacts = 0;
  std::size_t samples = 0;
  Quantiles field, peak, force;
  std::optional<Quantiles> total_force;  ///< layout::has_total_force
};

/// A model file's answers to contact patterns, as the loop gives them: every contact is stood for by its representative
/// on a constraint level, displacements of contacts that share one are averaged and forces shared out equally, and the
/// field has the coefficients of all levels. What is held at the finest level stands where it is held. Offline only.
class AnsweredContacts {
 public:
  /// The referenced objects must outlive this. `exact` has been solved for the domain rows of the same body.
  AnsweredContacts(const ModelView& view, const CompressedCompliance<3>& compressed, const ExactContacts& exact);

  /// The errors of the answers at constraint level `level`, with the details of levels 0 .. `details` in the field, to
  /// one site's samples, in their order. Work: `between` of its contacts and a field each.
  [[nodiscard]] std::vector<AnswerError> site_errors(std::size_t site, std::size_t level, std::size_t details) const;

  /// Those of all sites, one after the other; with all details, or those of some levels.
  [[nodiscard]] std::vector<AnswerError> all_errors(std::size_t level) const;
  [[nodiscard]] std::vector<AnswerError> all_errors(std::size_t level, std::size_t details) const;

 private:
  [[nodiscard]] std::vector<std::size_t> representatives(const std::vector<std::size_t>& rows, std::size_t level) const;
  void compare_fields(std::size_t site, std::size_t level, const std::vector<double>& found,
                      std::vector<AnswerError>& errors) const;

  const ModelView& view_;
  const CompressedCompliance<3>& compressed_;
  const ExactContacts& exact_;
  std::vector<std::uint32_t> place_;  // by file index: in the domain
  std::vector<double> area_;          // by row: m^2
  std::vector<bool> read_;            // by row
};

/// By kind, then by contacts.
[[nodiscard]] std::vector<PatternErrors> summarise(const std::vector<AnswerError>& errors);

/// As a model file stores them.
[[nodiscard]] std::vector<layout::PatternRecord> pattern_records(const std::vector<PatternErrors>& errors);

}  // namespace greenloop::offline
