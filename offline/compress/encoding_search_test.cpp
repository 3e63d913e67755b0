#include "offline/compress/encoding_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "offline/compress/dense_reference.hpp"
#include "offline/compress/exact_sample.hpp"
#include "offline/compress/field_error.hpp"

namespace greenloop::offline {
namespace {

constexpr double candidate_floor = 0.0005;

struct Bench {
  test::Body body = test::make_body(2);
  LinearWavelet wavelet{body.mesh, body.flags, body.area, true};
  WaveletCompliance compliance = transform_compliance(wavelet, test::columns_of(body.compliance), candidate_floor, {});
  ModelData tables = test::model_of(body, true, {.threshold = 0.1, .quantum = 0.05});
  ExactSample sample{body.mesh, wavelet, body.area};
  Bench() { sample.add(body.compliance, 0); }
  [[nodiscard]] TrialBench get() const { return {compliance, tables, sample.columns(), {}}; }
};

const Bench& bench() {
  static const Bench value;
  return value;
}

TEST_CASE("a trial says what its file is") {
  const Encoding encoding{.threshold = 0.01, .quantum = 0.005};
  auto with_work = bench().get();
  with_work.step_work = [](std::span<const std::byte> bytes) { return std::uint64_t{bytes.size() + 7}; };
  const auto trial = try_encoding(with_work, bench().sample.patches(), encoding);
  const test::File file(test::model_of(bench().body, true, encoding));
  CHECK(std::abs(static_cast<double>(trial.bytes) / static_cast<double>(file.bytes.size()) - 1) < 0.02);
  CHECK(trial.step_work == trial.bytes + 7);
  const CompressedCompliance compressed(file.view, layout::layers);
  CHECK(trial.patch_force == doctest::Approx(bench().sample.patches().worst_force_error(compressed, 2)).epsilon(0.05));
  const Eigen::MatrixXd found = test::dense_compliances(file.view, layout::layers).back();
  const double error = (found - bench().body.compliance).norm() / bench().body.compliance.norm();
  CHECK(trial.rms > 0.3 * error);
  CHECK(trial.rms < 3 * error);
}

TEST_CASE("the search finds the largest threshold that meets every accuracy") {
  const Accuracy wanted{.rms = 0.01, .worst_column = 0.03, .patch_force = 0.05};
  std::vector<Trial> trials;
  const auto& patches = bench().sample.patches();
  const auto best = search_encoding(bench().get(), patches, wanted, candidate_floor, trials, {});
  CHECK(best.meets(wanted));
  CHECK(trials.size() == 10);
  for (const auto& trial : trials) {
    if (trial.meets(wanted)) {
      CHECK(trial.bytes >= best.bytes);
    }
  }
  const double coarser = 1.2 * best.encoding.threshold;
  CHECK_FALSE(try_encoding(bench().get(), patches, {.threshold = coarser, .quantum = 0.5 * coarser}).meets(wanted));
}

TEST_CASE("if nothing meets the accuracy the most accurate trial comes back, after one trial") {
  std::vector<Trial> trials;
  const Accuracy wanted{.rms = 1e-9, .worst_column = 1e-9, .patch_force = 1e-9};
  const auto best = search_encoding(bench().get(), bench().sample.patches(), wanted, candidate_floor, trials, {});
  CHECK_FALSE(best.meets(wanted));
  CHECK(trials.size() == 1);
  CHECK(best.encoding.threshold == candidate_floor);
}

TEST_CASE("the worst patches are those with the largest errors") {
  const auto& patches = bench().sample.patches();
  const auto worst = worst_patches(bench().get(), patches, 5, 0.005);
  REQUIRE(worst.size() == 5);
  const test::File file(test::model_of(bench().body, true, {.threshold = 0.005, .quantum = 0.0025}));
  const CompressedCompliance compressed(file.view, layout::layers);
  std::vector<double> errors;
  errors.reserve(patches.size());
  for (std::size_t p = 0; p < patches.size(); ++p) errors.push_back(patches.force_error(compressed, 2, p));
  std::sort(errors.rbegin(), errors.rend());
  for (const std::size_t p : worst) CHECK(patches.force_error(compressed, 2, p) > 0.8 * errors[4]);
  CHECK(worst_patches(bench().get(), patches, 1000, 0.005).size() == patches.size());
}

FieldError field_errors(const Encoding& encoding) {
  const test::File file(test::model_of(bench().body, true, encoding));
  const CompressedCompliance field(file.view, layout::field_layers);
  FieldError error;
  for (const auto& column : bench().sample.columns()) error.add(field, 2, column.row, column.exact.data(), column.area);
  return error;
}

TEST_CASE("the field threshold is the largest whose couplings make an accurate field") {
  constexpr double rms = 0.02;
  const Encoding given{.threshold = 0.004, .quantum = 0.002, .field_threshold = 0, .field_weight = {}};
  const auto encoding = search_field_threshold(bench().get(), rms, given, {});
  CHECK(encoding.threshold == 0.004);
  CHECK(encoding.field_threshold > 0.001);
  CHECK(field_errors(encoding).rms() <= rms);
  Encoding coarser = encoding;
  coarser.field_threshold *= 1.2;
  CHECK(field_errors(coarser).rms() > rms);
  // where not even the least threshold meets it, all couplings make fields
  CHECK(search_field_threshold(bench().get(), 1e-9, given, {}).field_threshold == 0);
}

TEST_CASE("columns that are given weight become more accurate, their couplings more") {
  Encoding encoding{.threshold = 0.001, .quantum = 0.0005, .field_threshold = 0.05, .field_weight = {}};
  const std::size_t row = bench().wavelet.rows() - 1;
  const auto column_error = [&] {
    const test::File file(test::model_of(bench().body, true, encoding));
    const CompressedCompliance field(file.view, layout::field_layers);
    const Eigen::MatrixXd exact = bench().body.compliance.middleCols(static_cast<Eigen::Index>(3 * row), 3);
    return FieldError().add(field, 2, row, blocks_of(exact, 0).data(), 1);
  };
  const double before = column_error();
  weigh_columns(bench().wavelet, bench().compliance, {{.row = row, .excess = 2}}, encoding);
  const double once = column_error();
  CHECK(once < before);
  for (int k = 0; k < 8; ++k) {
    weigh_columns(bench().wavelet, bench().compliance, {{.row = row, .excess = 2}}, encoding);
  }
  CHECK(column_error() < 0.6 * before);
  REQUIRE(encoding.field_weight.size() == bench().wavelet.rows());
  CHECK(*std::min_element(encoding.field_weight.begin(), encoding.field_weight.end()) == 1);  // not all are reached
}

}  // namespace
}  // namespace greenloop::offline
