#include "offline/compress/field_thresholds.hpp"

#include <doctest/doctest.h>

#include "offline/compress/dense_reference.hpp"
#include "offline/compress/exact_sample.hpp"
#include "offline/compress/field_error.hpp"
#include "offline/compress/model_field.hpp"

namespace greenloop::offline {
namespace {

struct Case {
  test::Body body = test::make_body(3);
  ModelData model = test::model_of(body, layout::Wavelet::lifted_linear, {.threshold = 0.004, .quantum = 0.002});
  test::File file{model};
  CompressedCompliance compliance{file.view};
  ExactSample sample{body.mesh, compliance.wavelet(), body.area};
  Case() { sample.add(body.compliance, 0); }
};

const Case& one() {
  static const Case value;
  return value;
}

TEST_CASE("nothing left out is as accurate as all couplings; more left out less so, of fewer blocks") {
  const FieldSample field(one().compliance, read_rows(one().file.view), one().sample.columns());
  FieldError all;
  for (const auto& column : one().sample.columns()) {
    all.add(one().compliance.column(3, column.row), column.exact.data(), column.area);
  }
  auto before = field.measure({});
  CHECK(before.rms == doctest::Approx(all.rms()).epsilon(1e-6));
  CHECK(before.worst_column == doctest::Approx(all.worst_column()).epsilon(1e-6));
  CHECK(before.longest > 0.9 * static_cast<double>(one().compliance.rows(3)));
  for (const double spread : {0.001, 0.004, 0.016, 0.064}) {
    const auto outcome = field.measure({.spread = spread, .peak = 1});
    CHECK(outcome.rms > before.rms);
    CHECK(outcome.longest < before.longest);
    before = outcome;
  }
}

TEST_CASE("the thresholds chosen are the largest that meet both errors") {
  const FieldSample field(one().compliance, read_rows(one().file.view), one().sample.columns());
  const auto chosen = field.choose(0.02, 0.1);
  const auto outcome = field.measure(chosen);
  CHECK(outcome.rms <= 0.02);
  CHECK(outcome.worst_column <= 0.1);
  const auto coarser = field.measure({.spread = 1.1 * chosen.spread, .peak = chosen.peak});
  CHECK((coarser.rms > 0.02 || coarser.worst_column > 0.1));
  const auto none = field.choose(1e-9, 1e-9);
  CHECK(none.spread == 0);
  CHECK(none.peak == 0);
}

TEST_CASE("a body's columns are those of the sample, rounded to 8 bits") {
  const FieldThresholds thresholds{.spread = 0.004, .peak = 0.05};
  ModelData data = one().model;
  data.info.field_threshold = static_cast<float>(thresholds.spread);
  data.info.field_peak_threshold = static_cast<float>(thresholds.peak);
  const test::File file(data);
  const ModelField fields(file.view);
  FieldError error;
  for (const auto& column : one().sample.columns()) {
    REQUIRE(fields.has_column(3, column.row));
    error.add(fields.column(one().compliance.wavelet(), 3, column.row), column.exact.data(), column.area);
  }
  const FieldSample field(one().compliance, read_rows(one().file.view), one().sample.columns());
  const auto expected = field.measure(thresholds);
  CHECK(error.rms() == doctest::Approx(expected.rms).epsilon(0.02));
  CHECK(error.worst_column() == doctest::Approx(expected.worst_column).epsilon(0.05));
  CHECK(fields.counts().longest >= expected.longest);
}

}  // namespace
}  // namespace greenloop::offline
