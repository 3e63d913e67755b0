#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "offline/compress/measure/pattern_errors.hpp"
#include "offline/compress/search/encoding_search.hpp"

namespace greenloop::offline {

/// Contacts that the scene's accuracy of fields speaks of, at most.
inline constexpr std::uint32_t most_accurate_contacts = 64;

/// How many times too large the worst errors are: the largest of field / accuracy.field and peak / accuracy.field_peak,
/// and of field / accuracy.field_rough where layout::is_rough, over patterns of at most most_accurate_contacts
/// contacts; 0 if there are none.
[[nodiscard]] double pattern_excess(const std::vector<AnswerError>& errors, const Accuracy& accuracy);

/// The pattern whose worst errors are that much too large: by pattern_excess. `errors` is not empty.
[[nodiscard]] const PatternErrors& worst_pattern(const std::vector<PatternErrors>& errors, const Accuracy& accuracy);

/// The errors of an encoding's answers at the finest level to all sites, one after the other. Work: an encoding, and
/// that of AnsweredContacts.
[[nodiscard]] std::vector<AnswerError> answer_errors(const TrialBench& bench, const ExactContacts& contacts,
                                                     const Encoding& encoding);

/// An encoding, the model that it makes and the errors of its answers: those of answer_errors.
struct FoundEncoding {
  Encoding encoding;
  ModelFile model;
  std::vector<AnswerError> errors;
};

/// The encoding of a threshold near the largest from `floor` to `threshold` with which the answers at the finest level
/// to all sites are as accurate as bench.accuracy asks; none if there is none. Errors shrink about as thresholds do:
/// the search goes down in proportion, with the sites that were worst, and then checks all. Work: a few encodings.
[[nodiscard]] std::optional<FoundEncoding> search_threshold(const TrialBench& bench, const ExactContacts& contacts,
                                                            double threshold, double floor);

}  // namespace greenloop::offline
