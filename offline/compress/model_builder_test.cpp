#include "offline/compress/model_builder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "formats/aligned_bytes.hpp"
#include "formats/describe.hpp"
#include "offline/compress/force_error.hpp"
#include "offline/compress/hierarchy.hpp"
#include "offline/compress/node_order.hpp"
#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

layout::Info facts() {
  layout::Info info{};
  info.young = 1e5;
  info.poisson = 0.3;
  info.rate = 1000;
  info.max_contacts = 16;
  info.step_work = 1'000'000;
  return info;
}

ColumnSource columns_of(const test::Body& body) {
  return [&body](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return body.compliance.middleCols(static_cast<Eigen::Index>(3 * first), static_cast<Eigen::Index>(3 * count));
  };
}

CompressionInput input_of(const test::Body& body, const Accuracy& accuracy) {
  return {body.mesh, body.flags, body.area, body.column_nodes, columns_of(body), accuracy, facts(), "{}"};
}

const test::Body& body() {
  static const test::Body value = test::make_body(3);
  return value;
}

const BuiltModel& built() {
  static const BuiltModel value = build_model(input_of(body(), {0.03, 0.1}), {});
  return value;
}

/// Errors of a stored constraint level against exact columns, from the definition and in double precision.
struct Dense {
  double rms = 0, worst = 0;
};
Dense dense_errors(const LiftedLinear& wavelet, const LevelData& level, const Eigen::MatrixXd& exact) {
  double error = 0, norm = 0, worst = 0;
  for (std::size_t j = 0; j < level.columns.size(); ++j) {
    std::vector<double> x(9 * (wavelet.rows() + 1), 0.0);
    for (std::size_t r = 0; r < level.blocks.size(); ++r) {
      const auto& blocks = level.blocks[r];
      for (std::size_t b = blocks.begin[j]; b < blocks.begin[j + 1]; ++b) {
        const std::size_t row = wavelet.row_begin(r) + (blocks.dense ? b - blocks.begin[j] : blocks.index[b]);
        for (std::size_t k = 0; k < 9; ++k)
          x[9 * row + k] = static_cast<double>(blocks.scale[j]) * blocks.value[9 * b + k];
      }
    }
    wavelet.inverse(x.data());
    const double area = static_cast<double>(level.columns[j].area);
    double largest = 0, largest_error = 0;
    for (std::size_t i = 0; i < wavelet.rows(); ++i) {
      const Eigen::Matrix3d u =
          area * exact.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j));
      const Eigen::Matrix3d d = area * Eigen::Map<const Eigen::Matrix3d>(x.data() + 9 * i) - u;
      error += d.squaredNorm();
      norm += u.squaredNorm();
      largest = std::max(largest, u.norm());
      largest_error = std::max(largest_error, d.norm());
    }
    worst = std::max(worst, largest_error / largest);
  }
  return {std::sqrt(error / norm), worst};
}

TEST_CASE("every constraint level meets the accuracy asked for, by the definition and on all columns") {
  const auto& b = body();
  const LiftedLinear wavelet(b.mesh, b.flags, b.area);
  const auto& model = built().model;
  REQUIRE(model.levels.size() == 4);
  for (std::uint32_t c = 0; c < 4; ++c) {
    CAPTURE(c);
    const auto level = constraint_level(b.mesh, b.area, b.column_nodes, c);
    CoarseColumns exact(level, b.column_nodes.size());
    exact.add(b.compliance, 0);
    const auto dense = dense_errors(wavelet, model.levels[c], exact.source()(0, level.columns.size()));
    const auto& counts = model.levels[c].counts;
    CHECK(dense.rms <= 0.03);
    CHECK(dense.worst <= 0.1 * 1.0001);
    CHECK(static_cast<double>(counts.rms_error) == doctest::Approx(dense.rms).epsilon(1e-3));
    CHECK(static_cast<double>(counts.worst_column_error) == doctest::Approx(dense.worst).epsilon(1e-3));
    CHECK(dense.rms > 0.02);  // the accuracy was used up
  }
}

TEST_CASE("the report counts what is in the model") {
  const auto& report = built().report;
  const auto& model = built().model;
  REQUIRE(report.levels.size() == 4);
  for (const auto& level : report.levels) {
    const auto& data = model.levels[level.level];
    std::size_t blocks = 0;
    for (const auto& section : data.blocks) blocks += section.value.size() / 9;
    CHECK(level.kept_blocks == blocks);
    CHECK(level.columns == data.columns.size());
    CHECK(level.dense_blocks == level.columns * body().column_nodes.size());
    CHECK(level.kept_blocks < level.dense_blocks / 4);
  }
  CHECK(model.info.epsilon == report.levels.back().epsilon);
  REQUIRE(report.curve.size() == 8);
  for (std::size_t i = 1; i < report.curve.size(); ++i) {
    CHECK(report.curve[i].epsilon > report.curve[i - 1].epsilon);
    CHECK(report.curve[i].kept_blocks < report.curve[i - 1].kept_blocks);
    CHECK(report.curve[i].bytes < report.curve[i - 1].bytes);
    CHECK(report.curve[i].rms_error > report.curve[i - 1].rms_error);
  }
  // the chosen epsilon lies on the curve, but for the columns that were coded more finely
  const auto& chosen = report.levels.back();
  const auto above = std::find_if(report.curve.begin(), report.curve.end(),
                                  [&](const auto& point) { return point.epsilon > chosen.epsilon; });
  REQUIRE(above != report.curve.end());
  CHECK(static_cast<double>(chosen.kept_blocks) > 0.98 * above->kept_blocks);
}

TEST_CASE("the model becomes a file that verifies, whole and cut off, and is what the report says in size") {
  const auto file = encode(built().model);
  ModelView view;
  AlignedBytes aligned(file);
  const auto verdict = verify(aligned.span(), view);
  CHECK_MESSAGE(verdict.ok(), describe(verdict));
  CHECK(view.domain_count == body().column_nodes.size());
  std::size_t bytes = 0;
  for (const auto& level : built().report.levels) bytes += level.bytes;
  const std::size_t tables = body().mesh.positions.size() * (20 + 16 + 4 * 4);
  CHECK(file.size() > bytes);
  CHECK(file.size() < bytes + tables + 24'000);  // padding, headers, column records, base triangles
  for (std::uint32_t q = 0; q < 3; ++q) {
    AlignedBytes part(truncate_to_level(file, q));
    CHECK(verify(part.span(), view).ok());
  }
}

TEST_CASE("the finest level's patch forces are near the exact ones and coarser levels' are not singular") {
  const auto& levels = built().report.levels;
  CHECK(levels[3].force_error > 1e-4);
  CHECK(levels[3].force_error < 0.3);
  for (const auto& level : levels) CHECK(std::isfinite(level.force_error));
}

TEST_CASE("a model without loss has exact patch forces at the finest level") {
  const auto coarse_body = test::make_body(2);
  const auto exact = build_model(input_of(coarse_body, {1e-4, 1e-3}), {});
  CHECK(exact.report.levels.back().force_error < 0.01);
  CHECK(exact.report.levels.back().value_bytes.front() == 2);
}

TEST_CASE("the same input gives the same model") {
  const auto coarse_body = test::make_body(2);
  const auto a = build_model(input_of(coarse_body, {0.03, 0.1}), {});
  const auto b = build_model(input_of(coarse_body, {0.03, 0.1}), {});
  CHECK(encode(a.model) == encode(b.model));
}

TEST_CASE("constraint levels start where asked and where columns exist; progress runs from 0 to 1") {
  const auto coarse_body = test::make_body(2);
  auto input = input_of(coarse_body, {0.03, 0.1});
  input.facts.coarsest_constraint_level = 1;
  double last = 0;
  bool forward = true;
  const auto model = build_model(input, [&](double fraction, std::string_view) {
    forward = forward && fraction >= last && fraction <= 1;
    last = fraction;
  });
  CHECK(forward);
  CHECK(last == 1.0);
  CHECK(model.model.levels[0].columns.empty());
  CHECK(model.model.levels[0].blocks.empty());
  CHECK_FALSE(model.model.levels[1].columns.empty());
  CHECK(model.model.info.coarsest_constraint_level == 1);
}

TEST_CASE("only touched columns and needed rows are stored") {
  const auto& whole = body();
  auto flags = whole.flags;
  for (std::size_t node = 0; node < flags.size(); ++node) {
    const auto& p = whole.mesh.positions[node];
    flags[node] &= layout::node_fixed;
    if (p.z() > 0.2) flags[node] |= layout::node_read;
    if (p.z() > 0.4) flags[node] |= layout::node_touchable;
  }
  flags = mark_domain(whole.mesh, flags);
  const auto ordered = order_nodes(whole.mesh, flags);
  flags = ordered.reorder(flags);
  const auto area = ordered.reorder(whole.area);
  std::vector<std::size_t> columns;
  std::vector<Eigen::Index> rows;  // of the whole body's compliance
  for (std::size_t node = 0; node < flags.size(); ++node) {
    if ((flags[node] & layout::node_domain) == 0) continue;
    const auto row = std::lower_bound(whole.column_nodes.begin(), whole.column_nodes.end(), ordered.source[node]);
    rows.push_back(row - whole.column_nodes.begin());
    if ((flags[node] & layout::node_touchable) != 0) columns.push_back(node);
  }
  REQUIRE(columns.size() > 50);
  REQUIRE(rows.size() > columns.size() + 50);
  REQUIRE(rows.size() + 50 < whole.column_nodes.size());

  const ColumnSource source = [&](std::size_t first, std::size_t count) {
    Eigen::MatrixXd block(static_cast<Eigen::Index>(3 * rows.size()), static_cast<Eigen::Index>(3 * count));
    for (std::size_t j = 0; j < count; ++j) {
      const auto column =
          std::lower_bound(whole.column_nodes.begin(), whole.column_nodes.end(), ordered.source[columns[first + j]]) -
          whole.column_nodes.begin();
      for (std::size_t i = 0; i < rows.size(); ++i) {
        block.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
            whole.compliance.block<3, 3>(3 * rows[i], 3 * column);
      }
    }
    return block;
  };
  const auto part = build_model({ordered.mesh, flags, area, columns, source, {0.02, 0.05}, facts(), ""}, {});
  CHECK(part.report.levels.back().columns == columns.size());
  CHECK(part.report.levels.back().dense_blocks == columns.size() * rows.size());
  CHECK(part.report.levels.back().rms_error <= 0.02);
  CHECK(part.report.levels.back().worst_column_error <= 0.05);
  const auto file = encode(part.model);
  ModelView view;
  AlignedBytes aligned(file);
  const auto verdict = verify(aligned.span(), view);
  CHECK_MESSAGE(verdict.ok(), describe(verdict));
  CHECK(view.domain_count == rows.size());
}

TEST_CASE("a mesh of one level is stored without wavelets") {
  const auto b = test::make_body(0);
  const auto model = build_model(input_of(b, {1e-3, 1e-3}), {});
  REQUIRE(model.report.levels.size() == 1);
  CHECK(model.report.levels[0].kept_blocks == b.column_nodes.size() * b.column_nodes.size());
  CHECK(model.report.levels[0].rms_error <= 1e-3);
  CHECK(encode(model.model).size() > 0);
}

TEST_CASE("input that does not fit together is refused") {
  const auto b = test::make_body(1);
  auto columns = b.column_nodes;
  auto flags = b.flags;
  Accuracy accuracy{0.03, 0.1};
  layout::Info info = facts();
  ColumnSource source = columns_of(b);
  SUBCASE("no columns") { columns.clear(); }
  SUBCASE("a touchable node without a column") { columns.pop_back(); }
  SUBCASE("a column of a fixed node") {
    for (std::size_t node = 0; node < flags.size(); ++node) {
      if ((flags[node] & layout::node_fixed) != 0) columns.back() = node;
    }
    std::sort(columns.begin(), columns.end());
  }
  SUBCASE("no accuracy") { accuracy.rms = 0; }
  SUBCASE("a constraint level the mesh does not have") { info.coarsest_constraint_level = 2; }
  SUBCASE("columns of another size") {
    source = [&](std::size_t, std::size_t count) -> Eigen::MatrixXd {
      return Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(3 * count));
    };
  }
  SUBCASE("a column that is not finite") {
    source = [&](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
      Eigen::MatrixXd block = columns_of(b)(first, count);
      block(0, 0) = std::nan("");
      return block;
    };
  }
  const CompressionInput input{b.mesh, flags, b.area, columns, source, accuracy, info, ""};
  CHECK_THROWS_AS((void)build_model(input, {}), std::invalid_argument);
}

TEST_CASE("an accuracy that cannot be stored is refused by name") {
  const auto b = test::make_body(1);
  CHECK_THROWS_WITH_AS((void)build_model(input_of(b, {1e-8, 1e-8}), {}),
                       doctest::Contains("constraint level 0 cannot be stored"), std::runtime_error);
}

}  // namespace
}  // namespace greenloop::offline
