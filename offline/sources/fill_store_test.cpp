#include "offline/sources/fill_store.hpp"

#include <doctest/doctest.h>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "formats/layout.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/sources/reciprocity.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

/// A surface without a volume: columns at five of its nodes, rows at all.
GreenStoreContents measured_body() {
  GreenStoreContents contents;
  contents.surface = testing::ellipsoid(0, {1, 1, 1});
  const auto nodes = static_cast<int>(contents.surface.positions.size());
  contents.area.assign(contents.surface.positions.size(), 1.0);
  contents.flags.assign(contents.surface.positions.size(), layout::node_domain);
  for (int node = 0; node < nodes; ++node) contents.row_node.push_back(node);
  contents.column_node = {2, 3, 5, 7, 11};
  contents.young = 1e5;
  contents.poisson = 0.4;
  return contents;
}

/// Its columns are full of their numbers.
class NumberedColumns final : public ColumnSource {
 public:
  explicit NumberedColumns(const GreenStoreContents& contents)
      : row_set{.surface_nodes = contents.row_node}, nodes(contents.column_node) {}

  [[nodiscard]] int components() const override { return component_count; }
  [[nodiscard]] std::string_view unit() const override { return unit_name; }
  [[nodiscard]] const RowSet& rows() const override { return row_set; }
  [[nodiscard]] std::span<const int> column_nodes() const override { return nodes; }
  [[nodiscard]] std::size_t columns_at_once() const override { return 2; }
  [[nodiscard]] Eigen::MatrixXd read(std::span<const int> columns) override {
    asked.emplace_back(columns.begin(), columns.end());
    if (asked.size() > blocks_before_failure) throw std::runtime_error("killed");
    const auto n = static_cast<Eigen::Index>(component_count), rows = static_cast<Eigen::Index>(row_set.size());
    Eigen::MatrixXd block(n * rows, n * static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) {
      block.middleCols(n * static_cast<Eigen::Index>(k), n).setConstant(1.0 + columns[k]);
    }
    return block;
  }

  int component_count = 3;
  std::size_t blocks_before_failure = 100;
  std::string_view unit_name = "m/N";
  RowSet row_set;
  std::vector<int> nodes;
  std::vector<std::vector<int>> asked;
};

TEST_CASE("a store is filled with the columns it lacks, in blocks of neighbours") {
  const TemporaryFolder folder("greenloop-fill");
  const auto contents = measured_body();
  auto store = GreenStore::create(folder.path() / "fill.h5", contents);
  store.write_columns(1, Eigen::MatrixXd::Constant(36, 3, -1.0));
  NumberedColumns source(contents);
  std::vector<double> fractions;
  const auto report = fill_store(store, source, [&](const FillProgress& at) { fractions.push_back(at.fraction); });
  CHECK(report.columns == 4);
  CHECK(source.asked == std::vector<std::vector<int>>{{0}, {2, 3}, {4}});
  CHECK(fractions == std::vector<double>{0.4, 0.8, 1.0});
  const Eigen::MatrixXd columns = store.read_columns(0, 5);
  for (int c = 0; c < 5; ++c) CHECK(columns.middleCols<3>(3 * c).isConstant(c == 1 ? -1.0 : 1.0 + c));
  CHECK(fill_store(store, source).columns == 0);
}

TEST_CASE("a scalar store is filled from a source of its unit, where one that failed left off; others are refused") {
  const TemporaryFolder folder("greenloop-fill");
  auto contents = measured_body();
  contents.components = 1;
  contents.unit = "K/W";
  contents.young = contents.poisson = 0;
  const auto path = folder.path() / "scalar.h5";
  NumberedColumns source(contents);
  source.component_count = 1;
  source.unit_name = "K/W";
  {
    auto store = GreenStore::create(path, contents);
    source.blocks_before_failure = 1;
    CHECK_THROWS_WITH(fill_store(store, source), "killed");
  }
  source.blocks_before_failure = 100;
  source.asked.clear();
  auto store = GreenStore::open(path, GreenStore::Access::kReadWrite);
  CHECK(store.missing_columns() == std::vector<int>{2, 3, 4});
  CHECK(fill_store(store, source).columns == 3);
  CHECK(source.asked == std::vector<std::vector<int>>{{2, 3}, {4}});
  const Eigen::MatrixXd columns = store.read_columns(0, 5);
  CHECK(columns.rows() == 12);
  for (int c = 0; c < 5; ++c) CHECK(columns.col(c).isConstant(1.0 + c));

  NumberedColumns vectors(contents);
  CHECK_THROWS_WITH_AS(fill_store(store, vectors),
                       doctest::Contains("the store's columns have 1 components and are in K/W; the source's have 3 "
                                         "components and are in m/N"),
                       std::runtime_error);
  source.unit_name = "V/A";
  CHECK_THROWS_WITH_AS(fill_store(store, source), doctest::Contains("in V/A"), std::runtime_error);
}

TEST_CASE("how far scalar columns are from symmetric is found as that of blocks is") {
  const TemporaryFolder folder("greenloop-fill");
  auto contents = measured_body();
  contents.components = 1;
  contents.unit = "K/W";
  contents.young = contents.poisson = 0;
  contents.column_node = {2, 3, 5};
  auto store = GreenStore::create(folder.path() / "scalar.h5", contents);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(12, 3);
  columns(2, 0) = 4;
  columns(5, 0) = 1.5;  // 0.5 more than the load and answer exchanged, between diagonals of 4 and 1
  store.write_columns(0, columns);
  CHECK(largest_asymmetry(store) == doctest::Approx(0.25));
}

TEST_CASE("a source of other blocks, units, rows or columns than the store's is refused") {
  const TemporaryFolder folder("greenloop-fill");
  const auto contents = measured_body();
  auto store = GreenStore::create(folder.path() / "fill.h5", contents);
  const auto refuses = [&](const char* why, auto change) {
    NumberedColumns source(contents);
    change(source);
    CHECK_THROWS_WITH_AS(fill_store(store, source), doctest::Contains(why), std::runtime_error);
    CHECK(source.asked.empty());
  };
  refuses("1 components", [](NumberedColumns& source) { source.component_count = 1; });
  refuses("in K/W", [](NumberedColumns& source) { source.unit_name = "K/W"; });
  refuses("7 rows inside the body", [](NumberedColumns& source) { source.row_set.interior = 7; });
  refuses("row_node", [](NumberedColumns& source) { source.row_set.surface_nodes.pop_back(); });
  refuses("column_node", [](NumberedColumns& source) { source.nodes.back() = 9; });
}

}  // namespace
}  // namespace greenloop::offline
