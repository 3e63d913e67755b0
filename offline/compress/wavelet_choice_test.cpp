#include "offline/compress/wavelet_choice.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "formats/verify.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using layout::Wavelet;

const test::Body& body() {
  static const test::Body value = test::make_body(2);
  return value;
}

CompressionInput input_with(double error) {
  CompressionInput input{.mesh = body().mesh,
                         .flags = body().flags,
                         .area = body().area,
                         .column_nodes = body().column_nodes,
                         .columns = test::columns_of(body().compliance),
                         .accuracy = {.rms = error, .worst_column = 5 * error, .patch_force = 2 * error},
                         .facts = test::facts(),
                         .provenance = "{}",
                         .step_work = {}};
  input.facts.step_work = 0;  // no budget
  return input;
}

Wavelet wavelet_of(const ModelData& model) { return static_cast<Wavelet>(model.info.wavelet); }

template <class Cost>
Wavelet cheapest(const std::vector<WaveletTrial>& trials, Cost cost) {
  return std::min_element(trials.begin(), trials.end(),
                          [&](const auto& a, const auto& b) { return cost(a.trial) < cost(b.trial); })
      ->wavelet;
}

std::size_t bytes_of(const Trial& trial) { return trial.bytes; }

void check_comparison(const std::vector<WaveletTrial>& trials, std::size_t nodes, const Accuracy& accuracy) {
  REQUIRE(trials.size() == std::size(layout::wavelets));
  for (std::size_t k = 0; k < trials.size(); ++k) {
    CHECK(trials[k].wavelet == layout::wavelets[k]);
    CHECK(trials[k].nodes == nodes);
    CHECK(trials[k].trial.bytes > 0);
    CHECK(trials[k].trial.meets(accuracy));
  }
}

TEST_CASE("a small body is built with every wavelet, and the smallest file is kept") {
  const CompressionInput input = input_with(0.02);
  const BuiltModel built = build_with_best_wavelet(input, {});
  const auto& trials = built.report.wavelets;
  check_comparison(trials, body().column_nodes.size(), input.accuracy);
  CHECK(wavelet_of(built.model) == cheapest(trials, bytes_of));
  for (const WaveletTrial& trial : trials) {
    CompressionInput with = input;
    with.wavelet = trial.wavelet;
    const BuiltModel one = build_model(with, {});
    CHECK(one.report.wavelets.empty());
    CHECK(one.report.trials.back().bytes == trial.trial.bytes);
    CHECK((encode(one.model) == encode(built.model)) == (trial.wavelet == wavelet_of(built.model)));
  }
}

TEST_CASE("a larger body is built with the wavelet that is best for its nodes of a coarser level") {
  const CompressionInput input = input_with(0.02);
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, Wavelet::linear);
  double last = 0;
  const BuiltModel built = build_with_best_wavelet(
      input,
      [&](double fraction, std::string_view) {
        CHECK(fraction >= last);
        last = fraction;
      },
      30);
  CHECK(last == 1.0);
  check_comparison(built.report.wavelets, wavelet.row_end(1), input.accuracy);
  CHECK(wavelet_of(built.model) == cheapest(built.report.wavelets, bytes_of));
  CompressionInput with = input;
  with.wavelet = wavelet_of(built.model);
  CHECK(encode(build_model(with, {}).model) == encode(built.model));
}

TEST_CASE("where a budget of work is given, the product of bytes and work decides") {
  CompressionInput input = input_with(0.02);
  const Wavelet smallest = wavelet_of(build_with_best_wavelet(input, {}, 30).model);
  input.step_work = [&](std::span<const std::byte> bytes) {
    ModelView view;
    REQUIRE(verify(bytes, view).ok());
    const bool dear = static_cast<Wavelet>(view.info->wavelet) == smallest;
    return std::vector<std::uint64_t>(view.levels, dear ? 1000 : 10);
  };
  CHECK(wavelet_of(build_with_best_wavelet(input, {}, 30).model) == smallest);
  input.facts.step_work = 1000;
  const BuiltModel built = build_with_best_wavelet(input, {}, 30);
  CHECK(wavelet_of(built.model) != smallest);
  CHECK(wavelet_of(built.model) == cheapest(built.report.wavelets, [](const Trial& trial) {
          return static_cast<double>(trial.bytes) * static_cast<double>(trial.step_work);
        }));
}

TEST_CASE("an accuracy that no wavelet reaches on the sample is left to the body, which refuses it") {
  CHECK_THROWS_AS((void)build_with_best_wavelet(input_with(1e-9), {}, 30), std::runtime_error);
}

TEST_CASE("a mesh of one level has no wavelets to compare") {
  const test::Body flat = test::make_body(0);
  CompressionInput input{.mesh = flat.mesh,
                         .flags = flat.flags,
                         .area = flat.area,
                         .column_nodes = flat.column_nodes,
                         .columns = test::columns_of(flat.compliance),
                         .accuracy = {.rms = 0.02, .worst_column = 0.1, .patch_force = 0.05},
                         .facts = test::facts(),
                         .provenance = "{}",
                         .step_work = {}};
  CHECK(build_with_best_wavelet(input, {}).report.wavelets.empty());
}

}  // namespace
}  // namespace greenloop::offline
