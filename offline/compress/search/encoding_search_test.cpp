#include "offline/compress/search/encoding_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

constexpr double candidate_floor = 0.0005;
constexpr Accuracy asked{.rms = 0.02, .worst_column = 0.1, .patch_force = 0.2};

struct Bench {
  test::Body body = test::make_body(2);
  SurfaceWavelet wavelet{body.mesh, body.flags, body.area, layout::Wavelet::lifted_linear};
  WaveletCompliance<3> compliance =
      transform_compliance<3>(wavelet, test::columns_of(body.compliance), candidate_floor, {});
  ModelData tables = test::model_of(body, layout::Wavelet::lifted_linear, {.threshold = 0.1, .quantum = 0.05});
  ExactSample sample{body.mesh, wavelet, body.area};
  Bench() { sample.add(body.compliance, 0); }
  [[nodiscard]] TrialBench get() const { return {compliance, tables, sample.columns(), asked, {}}; }
};

const Bench& bench() {
  static const Bench value;
  return value;
}

TEST_CASE("a trial says what its file is") {
  const Encoding encoding{.threshold = 0.01, .quantum = 0.005};
  auto with_work = bench().get();
  with_work.step_work = [](std::span<const std::byte> bytes) {
    return std::vector<std::uint64_t>{0, bytes.size() + 7};
  };
  const auto trial = try_encoding(with_work, bench().sample.patches(), encoding);
  const test::File file(test::model_of(bench().body, layout::Wavelet::lifted_linear, encoding));
  CHECK(std::abs(static_cast<double>(trial.bytes) / static_cast<double>(file.bytes.size()) - 1) < 0.02);
  CHECK(trial.step_work == trial.bytes + 7);
  const CompressedCompliance<3> compressed(file.view);
  CHECK(trial.patch_force == doctest::Approx(bench().sample.patches().worst_force_error(compressed, 2)).epsilon(0.05));
  const Eigen::MatrixXd found = test::dense_compliances(file.view).back();
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
  const test::File file(
      test::model_of(bench().body, layout::Wavelet::lifted_linear, {.threshold = 0.005, .quantum = 0.0025}));
  const CompressedCompliance<3> compressed(file.view);
  std::vector<double> errors;
  errors.reserve(patches.size());
  for (std::size_t p = 0; p < patches.size(); ++p) errors.push_back(patches.force_error(compressed, 2, p));
  std::sort(errors.rbegin(), errors.rend());
  for (const std::size_t p : worst) CHECK(patches.force_error(compressed, 2, p) > 0.8 * errors[4]);
  CHECK(worst_patches(bench().get(), patches, 1000, 0.005).size() == patches.size());
}

}  // namespace
}  // namespace greenloop::offline
