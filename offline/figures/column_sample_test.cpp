#include "offline/figures/column_sample.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/figures/column_form.hpp"
#include "offline/figures/column_records.hpp"

namespace greenloop::offline {
namespace {

const std::vector<double> thresholds = {0.01, 0.05, 0.2};

struct Study {
  test::Body body = test::make_body(2);
  SurfaceWavelet wavelet{body.mesh, body.flags, body.area, layout::Wavelet::lifted_linear};
  ColumnCompression compression{wavelet, thresholds};

  [[nodiscard]] CompressedColumn compressed(std::size_t row) const {
    auto column = blocks_of(body.compliance, row);
    for (double& value : column) value *= body.area[wavelet.nodes()[row]];
    return compression.compress(column);
  }

  [[nodiscard]] std::vector<SampledRate> rates(const std::vector<Stratum>& strata) const {
    std::vector<std::vector<CompressedColumn>> columns;
    for (const Stratum& stratum : strata) {
      columns.emplace_back();
      for (const std::size_t row : stratum.rows) columns.back().push_back(compressed(row));
    }
    return estimate_rates(strata, columns, thresholds);
  }

  [[nodiscard]] std::vector<SampledRate> sampled(std::size_t count) const {
    return rates(stratified_sample(wavelet, count));
  }
};

const Study& study() {
  static const Study value;
  return value;
}

TEST_CASE("a sample of everything is the one-sided form itself") {
  const test::Body& body = study().body;
  const ExactBody exact{.name = "blob",
                        .mesh = body.mesh,
                        .flags = body.flags,
                        .area = body.area,
                        .columns = test::columns_of(body.compliance)};
  const auto whole = column_form_rates(exact, wavelet_kinds[3], thresholds, {}).back().points;
  const auto sampled = study().sampled(study().wavelet.rows());
  REQUIRE(sampled.size() == whole.size());
  for (std::size_t t = 0; t < whole.size(); ++t) {
    CHECK(sampled[t].point.ratio == doctest::Approx(whole[t].ratio).epsilon(1e-12));
    CHECK(sampled[t].point.rms == doctest::Approx(whole[t].rms).epsilon(1e-12));
    CHECK(sampled[t].point.worst_column == whole[t].worst_column);
    CHECK(sampled[t].ratio_error == 0);
    CHECK(sampled[t].rms_error == 0);
  }
}

TEST_CASE("a part of the columns tells what all are, within its standard error") {
  const auto all = study().sampled(study().wavelet.rows()), some = study().sampled(48);
  for (std::size_t t = 0; t < thresholds.size(); ++t) {
    CHECK(some[t].ratio_error > 0);
    CHECK(some[t].ratio_error < 0.1);
    CHECK(some[t].point.ratio == doctest::Approx(all[t].point.ratio).epsilon(3 * some[t].ratio_error));
    CHECK(some[t].point.rms == doctest::Approx(all[t].point.rms).epsilon(3 * some[t].rms_error));
  }
}

TEST_CASE("the standard error of a stratified mean is the textbook's") {
  const auto column = [](std::size_t kept) {
    return CompressedColumn{.exact_energy = 1, .trials = {{.kept = kept, .error_energy = 0.25, .worst = 0.5}}};
  };
  const std::vector<Stratum> strata = {{.size = 2, .rows = {0, 1}}, {.size = 8, .rows = {2, 5}}};
  const auto rate = estimate_rates(strata, {{column(1), column(3)}, {column(2), column(4)}}, {0.1}).front();
  CHECK(rate.point.ratio == doctest::Approx(100.0 / (4 + 8 * 3)));
  CHECK(rate.ratio_error == doctest::Approx(std::sqrt(8.0 * (8 - 2) * 2 / 2) / 28));
  CHECK(rate.point.rms == doctest::Approx(0.5));
  CHECK(rate.rms_error == doctest::Approx(0));
  CHECK(rate.point.worst_column == 0.5);
}

TEST_CASE("a larger sample begins with a smaller one and has some of every level") {
  const auto small = stratified_sample(study().wavelet, 40), large = stratified_sample(study().wavelet, 70);
  REQUIRE(small.size() == study().wavelet.finest() + 1);
  for (std::size_t s = 0; s < small.size(); ++s) {
    CHECK(small[s].rows.size() >= std::min<std::size_t>(small[s].size, 16));
    REQUIRE(large[s].rows.size() >= small[s].rows.size());
    CHECK(std::equal(small[s].rows.begin(), small[s].rows.end(), large[s].rows.begin()));
  }
  auto order = interleaved(small);
  const auto half = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  for (const Stratum& stratum : small) {
    const auto begin = *std::min_element(stratum.rows.begin(), stratum.rows.end());
    const auto early =
        std::count_if(order.begin(), half, [&](std::size_t row) { return row >= begin && row < begin + stratum.size; });
    CHECK(std::abs(early - static_cast<std::ptrdiff_t>(stratum.rows.size() / 2)) <= 1);
  }
  std::sort(order.begin(), order.end());
  CHECK(std::adjacent_find(order.begin(), order.end()) == order.end());
}

TEST_CASE("records are taken up again, and not for another body") {
  const auto file = std::filesystem::temp_directory_path() / ("greenloop-" + std::to_string(getpid()) + "-columns.csv");
  const CompressedColumn column = study().compressed(7);
  { ColumnRecords(file, "blob", thresholds).add(7, column); }
  {
    ColumnRecords again(file, "blob", thresholds);
    REQUIRE(again.has(7));
    CHECK_FALSE(again.has(8));
    CHECK(again.at(7).exact_energy == column.exact_energy);
    CHECK(again.at(7).trials[1].kept == column.trials[1].kept);
    CHECK(again.at(7).trials[1].error_energy == column.trials[1].error_energy);
    CHECK(again.at(7).trials[1].worst == column.trials[1].worst);
    again.add(8, column);
  }
  CHECK(ColumnRecords(file, "blob", thresholds).has(8));
  CHECK_THROWS_AS(ColumnRecords(file, "bear", thresholds), std::runtime_error);
  CHECK_THROWS_AS(ColumnRecords(file, "blob", {0.03}), std::runtime_error);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace greenloop::offline
