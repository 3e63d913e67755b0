#include "offline/compress/search/frontier.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "formats/verify.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t coarsest = 1, finest = 2;

struct Bench {
  test::Body body = test::make_body(2);
  SurfaceWavelet wavelet{body.mesh, body.flags, body.area, layout::Wavelet::lifted_linear};
  WaveletCompliance<3> compliance = transform_compliance<3>(wavelet, test::columns_of(body.compliance), 0.0005, {});
  ModelData tables = test::model_of(body, layout::Wavelet::lifted_linear, {.threshold = 0.1, .quantum = 0.05});
  ExactSample sample{body.mesh, wavelet, body.area};
  ContactPatches patches{{}, 0};
  Bench() {
    sample.add(body.compliance, 0);
    patches = sample.patches().choose({0, 1, 2});
    tables.info.coarsest_constraint_level = coarsest;
    tables.levels.front().representatives.clear();
  }
  [[nodiscard]] TrialBench get() const { return {compliance, tables, sample.columns(), {}, {}}; }
};

const Bench& bench() {
  static const Bench value;
  return value;
}

std::vector<Trial> tried(const std::vector<double>& thresholds) {
  std::vector<Trial> trials;
  trials.reserve(thresholds.size());
  for (const double threshold : thresholds) {
    trials.push_back(try_encoding(bench().get(), bench().patches, encoding_at(threshold)));
  }
  return trials;
}

std::vector<std::uint64_t> bytes_as_work(std::span<const std::byte> bytes) {
  return {bytes.size(), bytes.size() + 1, bytes.size() + 2};
}

TEST_CASE("a level's sample is its exact compliance") {
  const auto samples = sample_levels(bench().body.mesh, bench().wavelet, bench().compliance, coarsest);
  REQUIRE(samples.size() == finest - coarsest);
  const LevelSample& sample = samples.front();
  CHECK(sample.level == coarsest);
  CHECK(sample.patches.size() == LevelSample::most_patches);
  const Eigen::MatrixXd exact = test::level_compliances(bench().wavelet, bench().body.compliance)[coarsest];
  REQUIRE(sample.columns.size() == std::min(LevelSample::most_columns, bench().wavelet.row_end(coarsest)));
  for (const auto& column : sample.columns) {
    const Eigen::MatrixXd block = exact.middleCols(static_cast<Eigen::Index>(3 * column.row), 3);
    const auto wanted = blocks_of(block, 0);
    double most = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) most = std::max(most, std::abs(wanted[i] - column.exact[i]));
    CHECK(most < 1e-5 * block.norm());
  }
  auto all = ContactPatches(row_positions(bench().body.mesh, bench().wavelet, coarsest), LevelSample::most_patches);
  all.add(exact, 0);
  CHECK(sample.patches.worst_force_error(all) < 1e-3);
}

TEST_CASE("every threshold once, the latest trial of it, cheaper and less exact on every level as it grows") {
  const auto samples = sample_levels(bench().body.mesh, bench().wavelet, bench().compliance, coarsest);
  auto trials = tried({0.004, 0.03, 0.001, 0.004});
  trials.back().patch_force = 0.5;
  auto with_work = bench().get();
  with_work.step_work = bytes_as_work;
  const auto points = measure_frontier(with_work, bench().patches, samples, trials);
  REQUIRE(points.size() == 3);
  CHECK(points[0].encoding.threshold == 0.03);
  CHECK(points[1].patch_force == 0.5);
  for (const Trial& point : points) {
    REQUIRE(point.levels.size() == 2);
    CHECK(point.encoding.quantum == 0.5 * point.encoding.threshold);
    CHECK(point.levels[0].bytes < point.levels[1].bytes);
    CHECK(point.levels[1].bytes == point.bytes);
    CHECK(point.levels[1].patch_force == point.patch_force);
    CHECK(point.levels[1].rms == point.rms);
    CHECK(point.levels[0].step_work == point.bytes + 1);
    CHECK(point.levels[1].step_work == point.bytes + 2);
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    for (std::size_t level = 0; level < 2; ++level) {
      CHECK(points[i].levels[level].bytes > points[i - 1].levels[level].bytes);
      CHECK(points[i].levels[level].rms < points[i - 1].levels[level].rms);
    }
  }
}

TEST_CASE("gaps between the tried thresholds are filled, but not below the floor") {
  auto trials = tried({0.01, 0.045});
  fill_gaps(0.01, 0.008, trials);
  std::vector<double> thresholds;
  thresholds.reserve(trials.size());
  for (const Trial& trial : trials) thresholds.push_back(trial.encoding.threshold);
  CHECK(thresholds == std::vector<double>{0.01, 0.045, 0.16, 0.08, 0.02});
}

TEST_CASE("what is not tried yet is tried; what has its levels stays") {
  const auto samples = sample_levels(bench().body.mesh, bench().wavelet, bench().compliance, coarsest);
  const auto wanted = measure_frontier(bench().get(), bench().patches, samples, tried({0.02})).front();
  const Trial untried{.encoding = encoding_at(0.02)};
  Trial settled{.encoding = encoding_at(0.01), .bytes = 1};
  settled.levels = {{.level = 7}};
  const auto points = measure_frontier(bench().get(), bench().patches, samples, {untried, settled});
  REQUIRE(points.size() == 2);
  CHECK(points[0].bytes == wanted.bytes);
  CHECK(points[0].patch_force == wanted.patch_force);
  REQUIRE(points[0].levels.size() == wanted.levels.size());
  CHECK(points[0].levels[0].rms == wanted.levels[0].rms);
  CHECK(points[0].levels[1].rms == wanted.levels[1].rms);
  REQUIRE(points[1].levels.size() == 1);
  CHECK(points[1].levels[0].level == 7);
}

TEST_CASE("a level's errors are those of the model cut off after it") {
  const auto samples = sample_levels(bench().body.mesh, bench().wavelet, bench().compliance, coarsest);
  const auto point = measure_frontier(bench().get(), bench().patches, samples, tried({0.01})).front();
  const ModelFile whole = encoded_file(encoded_model(bench().get(), point.encoding));
  const auto bytes = whole.bytes.span();
  const AlignedBytes cut(truncate_to_level({bytes.begin(), bytes.end()}, coarsest));
  CHECK(point.levels[0].bytes == cut.size());
  CHECK(point.levels[0].step_work == 0);
  ModelView view;
  REQUIRE(verify(cut.span(), view).ok());
  CHECK(point.levels[0].blocks == view.level[coarsest].counts->kept_blocks);
  const CompressedCompliance<3> compressed(view);
  CHECK(point.levels[0].patch_force == samples[0].patches.worst_force_error(compressed, coarsest));
  const Eigen::MatrixXd exact = test::level_compliances(bench().wavelet, bench().body.compliance)[coarsest];
  const double error = (test::dense_compliances(view).back() - exact).norm() / exact.norm();
  CHECK(point.levels[0].rms > 0.3 * error);
  CHECK(point.levels[0].rms < 3 * error);
}

}  // namespace
}  // namespace greenloop::offline
