#include "offline/compress/model_builder.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "formats/verify.hpp"
#include "formats/write/describe.hpp"
#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/search/pattern_search.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/wavelet/node_order.hpp"

namespace greenloop::offline {
namespace {

constexpr Accuracy accuracy{.rms = 0.01, .worst_column = 0.03, .patch_force = 0.05};

CompressionInput input_of(const test::Body& body, const Accuracy& wanted) {
  return {body.mesh,
          body.flags,
          body.area,
          body.column_nodes,
          test::columns_of(body.compliance),
          wanted,
          layout::Wavelet::lifted_linear,
          test::facts(),
          "{}",
          {}};
}

const test::Body& body() {
  static const test::Body value = test::make_body(3);
  return value;
}

const BuiltModel& built() {
  static const BuiltModel value = build_model(input_of(body(), accuracy), {});
  return value;
}

const test::File& file() {
  static const test::File value(built().model);
  return value;
}

const test::Body& small_body() {
  static const test::Body value = test::make_body(2);
  return value;
}

struct Errors {
  double rms = 0, worst_column = 0;
};

// by the definition; area of the columns' nodes
Errors dense_errors(const Eigen::MatrixXd& found, const Eigen::MatrixXd& exact, const std::vector<double>& area) {
  double error = 0, norm = 0, worst = 0;
  for (std::size_t j = 0; j < area.size(); ++j) {
    double largest = 0, largest_error = 0;
    for (Eigen::Index i = 0; i < exact.rows(); i += 3) {
      const auto column = static_cast<Eigen::Index>(3 * j);
      const Eigen::Matrix3d u = area[j] * exact.block<3, 3>(i, column);
      const Eigen::Matrix3d d = area[j] * found.block<3, 3>(i, column) - u;
      error += d.squaredNorm();
      norm += u.squaredNorm();
      largest = std::max(largest, u.norm());
      largest_error = std::max(largest_error, d.norm());
    }
    worst = std::max(worst, largest_error / largest);
  }
  return {std::sqrt(error / norm), worst};
}

TEST_CASE("the model meets the accuracies, measured on a dense evaluation of its bytes") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  const auto exact = test::level_compliances(wavelet, body().compliance);
  const auto found = test::dense_compliances(file().view);
  REQUIRE(built().report.levels.size() == 4);
  for (const auto& level : built().report.levels) {
    CAPTURE(level.level);
    const auto errors = dense_errors(found[level.level], exact[level.level], wavelet.integrals(level.level));
    CHECK(level.rms_error == doctest::Approx(errors.rms).epsilon(1e-3));
    CHECK(level.worst_column_error == doctest::Approx(errors.worst_column).epsilon(1e-3));
    const auto& counts = *file().view.level[level.level].counts;
    CHECK(static_cast<double>(counts.rms_error) == doctest::Approx(level.rms_error));
    CHECK(static_cast<double>(counts.worst_column_error) == doctest::Approx(level.worst_column_error));
    CHECK(static_cast<double>(counts.patch_force_error) == doctest::Approx(level.patch_force_error));
  }
  const auto finest = dense_errors(found[3], exact[3], wavelet.integrals(3));
  CHECK(finest.rms <= accuracy.rms);
  CHECK(finest.worst_column <= accuracy.worst_column);
}

TEST_CASE("where everything is read the errors of fields are those of the compliance, and the file says so") {
  for (const auto& level : built().report.levels) {
    CHECK(level.field_rms_error == level.rms_error);
    CHECK(level.field_column_error == level.worst_column_error);
    const auto& counts = *file().view.level[level.level].counts;
    CHECK(static_cast<double>(counts.field_rms_error) == doctest::Approx(level.field_rms_error));
    CHECK(static_cast<double>(counts.field_column_error) == doctest::Approx(level.field_column_error));
    CHECK(level.field.blocks == 2 * level.kept_blocks - level.nodes);
    CHECK(level.field.longest > 0);
    CHECK(level.field.longest < level.field.blocks);
  }
}

TEST_CASE("fields are as accurate as asked where they are read and sum fewer blocks than those of the whole body") {
  test::Body part = body();
  const auto is_read = [&](std::size_t node) { return part.mesh.positions[node].x() > 0.6; };
  for (std::size_t node = 0; node < part.flags.size(); ++node) {
    if (!is_read(node)) part.flags[node] &= ~std::uint32_t{layout::node_read};
  }
  const BuiltModel model = build_model(input_of(part, accuracy), {});
  const test::File stored(model.model);
  CHECK(stored.view.domain_count == file().view.domain_count);
  const auto& finest = model.report.levels.back();
  CHECK(static_cast<double>(finest.field.blocks) <
        0.7 * static_cast<double>(built().report.levels.back().field.blocks));
  const Eigen::MatrixXd found = test::dense_compliances(stored.view).back();
  double error = 0, exact = 0;
  for (std::size_t j = 0; j < part.column_nodes.size(); ++j) {
    const double area = part.area[part.column_nodes[j]];
    for (std::size_t i = 0; i < part.column_nodes.size(); ++i) {
      if (!is_read(part.column_nodes[i])) continue;
      const auto row = static_cast<Eigen::Index>(3 * i), column = static_cast<Eigen::Index>(3 * j);
      const Eigen::Matrix3d wanted = part.compliance.block<3, 3>(row, column);
      error += area * area * (found.block<3, 3>(row, column) - wanted).squaredNorm();
      exact += area * area * wanted.squaredNorm();
    }
  }
  CHECK(std::sqrt(error / exact) <= accuracy.rms);
  CHECK(std::sqrt(error / exact) == doctest::Approx(finest.field_rms_error).epsilon(1e-3));
}

TEST_CASE("forces of all patches meet their accuracy, and it is used up") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  ContactPatches patches(row_positions(body().mesh, wavelet, 3), ExactSample::most_patches);
  patches.add(body().compliance, 0);
  const double error = patches.worst_force_error(CompressedCompliance<3>(file().view), 3);
  CHECK(error <= accuracy.patch_force);
  CHECK(error > 0.3 * accuracy.patch_force);
  CHECK(built().report.levels.back().patch_force_error == doctest::Approx(error).epsilon(1e-6));
  CHECK(built().report.patches == patches.size());
}

TEST_CASE("the certified bound lies below the least eigenvalue") {
  const auto found = test::dense_compliances(file().view).back();
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(found, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
  CHECK(built().report.lambda_min > 0.3 * least);
  CHECK(built().report.lambda_min < 0.6 * least);
  CHECK(file().view.info->lambda_min == built().report.lambda_min);
}

TEST_CASE("cut off after any level it is a valid model, as accurate as reported") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  const auto exact = test::level_compliances(wavelet, body().compliance);
  for (std::uint32_t q = 0; q < 3; ++q) {
    CAPTURE(q);
    const AlignedBytes part(truncate_to_level(encode(built().model), q));
    CHECK(part.size() < file().bytes.size());
    ModelView view;
    const auto verdict = verify(part.span(), view);
    REQUIRE_MESSAGE(verdict.ok(), describe(verdict));
    const auto errors = dense_errors(test::dense_compliances(view).back(), exact[q], wavelet.integrals(q));
    CHECK(static_cast<double>(view.level[q].counts->rms_error) == doctest::Approx(errors.rms).epsilon(1e-3));
    CHECK(errors.rms < 2 * accuracy.rms);
  }
}

TEST_CASE("the report counts what is in the file") {
  const auto& report = built().report;
  for (const auto& level : report.levels) {
    CHECK(level.nodes == CompressedCompliance<3>(file().view).rows(level.level));
    CHECK(level.dense_blocks == level.nodes * level.nodes);
    CHECK(level.kept_blocks == file().view.level[level.level].counts->kept_blocks);
  }
  CHECK(report.dense_bytes == 36 * body().column_nodes.size() * body().column_nodes.size());
  REQUIRE(report.trials.size() > 2);
  CHECK(report.trials.back().encoding.threshold == report.encoding.threshold);
  CHECK(report.trials.back().bytes == file().bytes.size());
  CHECK(report.trials.back().meets(accuracy));
  CHECK(file().view.info->threshold == report.encoding.threshold);
}

TEST_CASE("the frontier's chosen point has the model's own figures on every level") {
  const auto& report = built().report;
  REQUIRE(report.frontier.size() > 2);
  const auto chosen = std::find_if(report.frontier.begin(), report.frontier.end(), [&](const Trial& point) {
    return point.encoding.threshold == report.encoding.threshold;
  });
  REQUIRE(chosen != report.frontier.end());
  REQUIRE(chosen->levels.size() == report.levels.size());
  for (std::size_t i = 0; i < report.levels.size(); ++i) {
    const LevelTrial& level = chosen->levels[i];
    CHECK(level.level == report.levels[i].level);
    CHECK(level.blocks == report.levels[i].kept_blocks);
    CHECK(level.rms == report.levels[i].rms_error);
    CHECK(level.worst_column == report.levels[i].worst_column_error);
    CHECK(level.patch_force == report.levels[i].patch_force_error);
    CHECK(level.bytes == truncate_to_level(encode(built().model), level.level).size());
  }
}

TEST_CASE("the same input gives the same bytes; progress runs forward to 1") {
  double last = 0;
  bool forward = true;
  const auto a = build_model(input_of(small_body(), accuracy), [&](double fraction, std::string_view) {
    forward = forward && fraction >= last && fraction <= 1;
    last = fraction;
  });
  CHECK(forward);
  CHECK(last == 1.0);
  CHECK(encode(a.model) == encode(build_model(input_of(small_body(), accuracy), {}).model));
}

TEST_CASE("every constraint level says how right its answers to patterns are, in the report and in the file") {
  const auto& report = built().report;
  for (const auto& level : report.levels) {
    const auto stored = file().view.level[level.level].patterns;
    const auto expected = pattern_records(level.patterns);
    REQUIRE(stored.size() == expected.size());
    CHECK(std::memcmp(stored.data(), expected.data(), stored.size_bytes()) == 0);
    std::size_t kinds = 0;
    for (std::size_t i = 0; i < stored.size(); ++i) kinds += i == 0 || stored[i].kind != stored[i - 1].kind ? 1 : 0;
    CHECK(kinds == layout::pattern_kinds);
  }
  const auto worst = [&](std::size_t level) {
    double errors = 0;
    for (const auto& pattern : report.levels[level].patterns) errors = std::max(errors, pattern.force.worst);
    return errors;
  };
  CHECK(worst(report.levels.size() - 1) < 0.5 * worst(report.levels.size() - 2));
}

TEST_CASE("fields are as accurate as asked for, and no more than need be") {
  Accuracy wanted = accuracy;
  wanted.field = 0.01;
  wanted.field_peak = 0.02;
  const auto fine = build_model(input_of(small_body(), wanted), {});
  const auto loose = build_model(input_of(small_body(), accuracy), {});
  const auto& patterns = fine.report.levels.back().patterns;
  for (const auto& pattern : patterns) {
    CHECK(pattern.field.worst <= wanted.field);
    CHECK(pattern.peak.worst <= wanted.field_peak);
  }
  const auto& worst = worst_pattern(patterns, wanted);
  CHECK(std::max(worst.field.worst / wanted.field, worst.peak.worst / wanted.field_peak) > 0.6);
  CHECK(fine.report.encoding.threshold < loose.report.encoding.threshold);
  CHECK(fine.report.trials.back().bytes == encode(fine.model).size());
}

TEST_CASE("fields that cannot be made as accurate as asked for are refused with the pattern that fails") {
  Accuracy wanted = accuracy;
  wanted.field = 1e-9;
  const auto b = test::make_body(1);
  CHECK_THROWS_WITH_AS((void)build_model(input_of(b, wanted), {}),
                       doctest::Contains("cannot be met; the best found for the pattern `"), std::runtime_error);
}

TEST_CASE("constraint levels start where asked") {
  auto input = input_of(small_body(), accuracy);
  input.facts.coarsest_constraint_level = 1;
  const auto model = build_model(input, {});
  CHECK(model.model.levels[0].representatives.empty());
  CHECK_FALSE(model.model.levels[1].representatives.empty());
  REQUIRE(model.report.levels.size() == 2);
  CHECK(model.report.levels[0].level == 1);
  CHECK(test::File(model.model).view.info->coarsest_constraint_level == 1);
}

TEST_CASE("only needed nodes are stored") {
  const auto& whole = small_body();
  auto flags = whole.flags;
  for (std::size_t node = 0; node < flags.size(); ++node) {
    flags[node] &= layout::node_fixed;
    if (whole.mesh.positions[node].z() > 0.2) flags[node] |= layout::node_read | layout::node_touchable;
  }
  flags = mark_domain(whole.mesh, flags);
  const auto ordered = order_nodes(whole.mesh, flags);
  test::Body part{.mesh = ordered.mesh,
                  .flags = ordered.reorder(flags),
                  .area = ordered.reorder(whole.area),
                  .column_nodes = {},
                  .compliance = {}};
  std::vector<Eigen::Index> unknowns;
  for (std::size_t node = 0; node < part.flags.size(); ++node) {
    if ((part.flags[node] & layout::node_domain) == 0) continue;
    part.column_nodes.push_back(node);
    const auto row = std::lower_bound(whole.column_nodes.begin(), whole.column_nodes.end(), ordered.source[node]);
    for (int k = 0; k < 3; ++k) unknowns.push_back(3 * (row - whole.column_nodes.begin()) + k);
  }
  part.compliance = whole.compliance(unknowns, unknowns);
  REQUIRE(part.column_nodes.size() > 30);
  REQUIRE(part.column_nodes.size() + 30 < whole.column_nodes.size());
  const auto model = build_model(input_of(part, accuracy), {});
  CHECK(model.report.trials.back().meets(accuracy));
  const test::File stored(model.model);
  CHECK(stored.view.domain_count == part.column_nodes.size());
  const auto found = test::dense_compliances(stored.view).back();
  CHECK((found - part.compliance).norm() < 2 * accuracy.rms * part.compliance.norm());
}

TEST_CASE("a mesh of one level is stored without wavelets") {
  const auto b = test::make_body(0);
  const auto model = build_model(input_of(b, {1e-3, 1e-3, 1e-3}), {});
  REQUIRE(model.report.levels.size() == 1);
  CHECK(model.report.levels[0].rms_error <= 1e-3);
}

TEST_CASE("input that does not fit together is refused") {
  const auto b = test::make_body(1);
  auto columns = b.column_nodes;
  auto flags = b.flags;
  Accuracy wanted = accuracy;
  auto info = test::facts();
  ExactColumns source = test::columns_of(b.compliance);
  SUBCASE("a column is missing") { columns.pop_back(); }
  SUBCASE("a column of a fixed node") { columns.back() = 0; }
  SUBCASE("nothing can be touched") {
    for (auto& flag : flags) flag &= ~std::uint32_t{layout::node_touchable};
  }
  SUBCASE("no node is free and needed") {
    columns.clear();
    std::fill(flags.begin(), flags.end(), layout::node_fixed);
  }
  SUBCASE("flags of another mesh") { flags.pop_back(); }
  SUBCASE("rms of zero") { wanted.rms = 0; }
  SUBCASE("a negative patch force") { wanted.patch_force = -1; }
  SUBCASE("a field error of zero") { wanted.field = 0; }
  SUBCASE("a peak error that is no number") { wanted.field_peak = std::numeric_limits<double>::quiet_NaN(); }
  SUBCASE("a worst column that is no number") { wanted.worst_column = std::numeric_limits<double>::quiet_NaN(); }
  SUBCASE("a constraint level the mesh does not have") { info.coarsest_constraint_level = 2; }
  SUBCASE("columns of another size") {
    source = [](std::size_t, std::size_t count) -> Eigen::MatrixXd {
      return Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(3 * count));
    };
  }
  SUBCASE("a column that is not finite") {
    source = [&](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
      Eigen::MatrixXd block = test::columns_of(b.compliance)(first, count);
      block(0, 0) = std::nan("");
      return block;
    };
  }
  const CompressionInput input{b.mesh, flags, b.area, columns, source, wanted, layout::Wavelet::lifted_linear,
                               info,   "",    {}};
  CHECK_THROWS_AS((void)build_model(input, {}), std::invalid_argument);
}

TEST_CASE("an accuracy that cannot be met is refused in numbers") {
  const auto b = test::make_body(1);
  CHECK_THROWS_WITH_AS((void)build_model(input_of(b, {1e-9, 1e-9, 1e-9}), {}), doctest::Contains("cannot be met"),
                       std::runtime_error);
}

}  // namespace
}  // namespace greenloop::offline
