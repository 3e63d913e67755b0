#pragma once

#include <optional>
#include <string>
#include <vector>

#include "offline/figures/column_form.hpp"
#include "offline/figures/exact_body.hpp"
#include "offline/figures/rate_curve.hpp"
#include "offline/figures/summation.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// What is tried on every body.
struct ComparisonPlan {
  std::vector<double> column_thresholds = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5};         ///< epsilon
  std::vector<double> two_sided_thresholds = {0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};  ///< tau
  std::vector<double> quanta = {0.25, 0.35, 0.5, 0.7, 1};                                          ///< of tau
  std::vector<double> summation_thresholds = {0.0025, 0.0035, 0.005, 0.007, 0.01};  ///< tau, of models timed
  std::size_t contacts = 16, rounds = 30;                                           ///< of the summation
};

/// The two forms with one wavelet, on every constraint level, coarse to fine.
struct FormRates {
  std::string wavelet;
  std::vector<LevelRates> column, two_sided;
};

/// The finest level of the two-sided form with another quantum.
struct QuantumRates {
  double quantum = 0;  ///< of tau
  std::vector<RatePoint> points;
};

/// One body measured; `quanta` and `summation` with the last wavelet of `forms`.
struct BodyComparison {
  std::string name;
  std::size_t rows = 0;  ///< free nodes
  std::vector<FormRates> forms;
  std::vector<QuantumRates> quanta;
  std::vector<SummationPoint> summation;
};

/// Streams the columns twice per wavelet. Memory: a third of the dense matrix in single precision and what
/// transform_compliance takes.
[[nodiscard]] BodyComparison compare_forms(const ExactBody& body, const ComparisonPlan& plan, const Progress& progress);

/// How much more the larger of two bodies compresses at the same RMS error (James & Pai 2003, equation 73), with the
/// last wavelet; empty where a body has no such error.
struct Growth {
  std::string from, to;
  double rms = 0;
  std::optional<double> column, two_sided;  ///< ratio of the ratios
};

/// Between neighbours of `bodies`, from fewer free nodes to more.
[[nodiscard]] std::vector<Growth> growth(std::vector<BodyComparison> bodies);

}  // namespace greenloop::offline
