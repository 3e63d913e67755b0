#include "formats/store/green_store.hpp"

#include <doctest/doctest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "formats/store/hdf5_file.hpp"
#include "formats/testing/small_store.hpp"

namespace greenloop {
namespace {

using Access = GreenStore::Access;
using Eigen::MatrixXd;

TEST_CASE("a store gives back what was put into it") {
  const TemporaryFile file("roundtrip.h5");
  const auto contents = small_contents(7);
  {
    auto store = GreenStore::create(file.path, contents);
    store.write_columns(2, column_values(2, 17));
    MatrixXd wide(3 * 17, 6);
    wide << column_values(4, 17), column_values(5, 17);
    store.write_columns(4, wide);
  }
  const auto store = GreenStore::open(file.path, Access::kReadOnly);
  const auto& found = store.contents();
  CHECK(found.surface.positions == contents.surface.positions);
  CHECK(found.surface.parents == contents.surface.parents);
  CHECK(found.surface.vertex_end == contents.surface.vertex_end);
  CHECK(found.surface.base_triangles == contents.surface.base_triangles);
  CHECK(found.area == contents.area);
  CHECK(found.flags == contents.flags);
  CHECK(found.row_node == contents.row_node);
  CHECK(found.column_node == contents.column_node);
  CHECK(found.volume.vertices == contents.volume.vertices);
  CHECK(found.volume.tetrahedra == contents.volume.tetrahedra);
  CHECK(found.volume_fixed == contents.volume_fixed);
  CHECK((found.interpolation - contents.interpolation).norm() == 0.0);
  CHECK(found.young == contents.young);
  CHECK(found.poisson == contents.poisson);
  CHECK(found.elements == Elements::linear);
  CHECK(found.provenance == contents.provenance);
  CHECK(found.fingerprint == contents.fingerprint);
  CHECK(store.missing_columns() == std::vector<int>{0, 1, 3, 6});
  CHECK(store.is_done(5));
  CHECK(store.read_columns(5, 1) == column_values(5, 17));
  CHECK(store.read_block(3, 4, 5, 1) == column_values(5, 17).middleRows(9, 12));
  CHECK_THROWS_WITH((void)store.read_columns(2, 2), doctest::Contains("column 3 is not solved yet"));
  CHECK_THROWS_WITH((void)store.read_columns(6, 2), doctest::Contains("outside"));
}

TEST_CASE("a store says what elements its columns are of, and takes no others") {
  const TemporaryFile file("elements.h5");
  auto contents = small_contents(3);
  contents.elements = Elements::quadratic;
  GreenStore::create(file.path, contents).close();
  CHECK(GreenStore::open(file.path, Access::kReadOnly).contents().elements == Elements::quadratic);
  GreenStore::create(file.path, small_contents(3)).close();
  {
    auto hdf5 = Hdf5File::open(file.path, true);
    hdf5.write_text("/", "elements", "cubic");
    hdf5.close();
  }
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly),
                    doctest::Contains("elements must be 'quadratic', or absent"));
}

TEST_CASE("a scalar store gives back what was put into it: a number a node, in its own unit, without a material") {
  const TemporaryFile file("scalar.h5");
  {
    auto store = GreenStore::create(file.path, scalar_contents(7));
    store.write_columns(2, column_values(2, 17, 1));
    MatrixXd wide(17, 2);
    wide << column_values(4, 17, 1), column_values(5, 17, 1);
    store.write_columns(4, wide);
  }
  {
    const auto hdf5 = Hdf5File::open(file.path, false);
    CHECK(hdf5.shape("/green/displacement") == Hdf5Shape{7, 1, 17, 1});
    CHECK_THROWS_WITH((void)hdf5.read_number("/", "young"), doctest::Contains("missing"));
  }
  const auto store = GreenStore::open(file.path, Access::kReadOnly);
  CHECK(store.contents().components == 1);
  CHECK(store.contents().unit == "K/W");
  CHECK(store.contents().young == 0);
  CHECK(store.contents().volume.tetrahedra == small_contents(7).volume.tetrahedra);
  CHECK(store.missing_columns() == std::vector<int>{0, 1, 3, 6});
  CHECK(store.read_columns(4, 2).col(1) == column_values(5, 17, 1));
  CHECK(store.read_block(3, 4, 5, 1) == column_values(5, 17, 1).middleRows(3, 4));
  store.require_components(1);
  CHECK_THROWS_WITH(store.require_components(3), doctest::Contains("1 numbers a node, in K/W; 3 are taken here"));
}

TEST_CASE("a part of a larger matrix can be written without a gap") {
  const TemporaryFile file("stride.h5");
  auto store = GreenStore::create(file.path, small_contents(3));
  MatrixXd larger = MatrixXd::Constant(60, 3, -1.0);
  larger.topRows(51) = column_values(1, 17);
  store.write_columns(1, larger.topRows(51));
  CHECK(store.read_columns(1, 1) == column_values(1, 17));
}

TEST_CASE("a store without a volume is for columns from elsewhere") {
  const TemporaryFile file("measured.h5");
  auto contents = small_contents(3);
  contents.volume = {};
  contents.volume_fixed.clear();
  { auto store = GreenStore::create(file.path, contents); }
  CHECK(GreenStore::open(file.path, Access::kReadOnly).contents().volume.vertices.empty());
}

TEST_CASE("a store with a volume has room for a body force, which is done once it is written and stays") {
  const TemporaryFile file("body_force.h5");
  const MatrixXd moved = column_values(4, 17);
  {
    auto store = GreenStore::create(file.path, small_contents(3));
    CHECK(store.has_body_force_room());
    CHECK(!store.is_body_force_done());
    CHECK_THROWS_WITH((void)store.read_body_force(), doctest::Contains("not solved yet"));
    MatrixXd bad = moved;
    bad(7, 1) = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(store.write_body_force(bad), doctest::Contains("not finite"));
    CHECK_THROWS_WITH(store.write_body_force(column_values(4, 16)), doctest::Contains("48 x 3 does not fit; 51 x 3"));
    CHECK(!store.is_body_force_done());
    store.write_body_force(moved);
  }
  auto store = GreenStore::open(file.path, Access::kReadOnly);
  CHECK(store.is_body_force_done());
  CHECK(store.read_body_force() == moved);
  CHECK_THROWS_WITH(store.write_body_force(moved), doctest::Contains("read-only"));
}

TEST_CASE("stores of a scalar problem, or without a volume, have no room for a body force") {
  const TemporaryFile file("no_body_force.h5");
  auto contents = small_contents(3);
  contents.volume = {};
  contents.volume_fixed.clear();
  for (const auto& without : {contents, scalar_contents(3)}) {
    auto store = GreenStore::create(file.path, without);
    CHECK(!store.has_body_force_room());
    CHECK(!store.is_body_force_done());
    CHECK_THROWS_WITH((void)store.read_body_force(), doctest::Contains("has no body force"));
    CHECK_THROWS_WITH(store.write_body_force(column_values(4, 17)), doctest::Contains("no room"));
  }
}

TEST_CASE("what is not finite, does not fit or may not be written is refused") {
  const TemporaryFile file("refuse.h5");
  {
    auto store = GreenStore::create(file.path, small_contents(3));
    MatrixXd bad = column_values(0, 17);
    bad(7, 1) = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(store.write_columns(0, bad), doctest::Contains("not finite"));
    CHECK_THROWS_WITH(store.write_columns(0, column_values(0, 16)), doctest::Contains("does not fit"));
    CHECK_THROWS_WITH(store.write_columns(3, column_values(0, 17)), doctest::Contains("outside"));
    CHECK(store.missing_columns().size() == 3);
  }
  {
    auto scalar = GreenStore::create(file.path, scalar_contents(3));
    CHECK_THROWS_WITH(scalar.write_columns(0, column_values(0, 17)), doctest::Contains("1 rows per row node (17)"));
    CHECK_THROWS_WITH(scalar.write_columns(2, MatrixXd::Ones(17, 2)), doctest::Contains("outside"));
  }
  auto read_only = GreenStore::open(file.path, Access::kReadOnly);
  CHECK_THROWS_WITH(read_only.write_columns(0, column_values(0, 17)), doctest::Contains("read-only"));
}

TEST_CASE("contents that contradict each other are refused by name") {
  const TemporaryFile file("contents.h5");
  const auto refuse = [&](auto change, const char* name) {
    auto contents = small_contents(3);
    change(contents);
    CHECK_THROWS_WITH_AS((void)GreenStore::create(file.path, contents), doctest::Contains(name), std::invalid_argument);
    CHECK(!std::filesystem::exists(file.path));
  };
  refuse([](auto& c) { c.area[4] = 0.0; }, "/surface/area[4]");
  refuse([](auto& c) { c.flags.pop_back(); }, "/surface/flags");
  refuse([](auto& c) { c.flags[7] = 16; }, "/surface/flags[7]");
  refuse([](auto& c) { c.surface.parents[8] = {3, 3}; }, "/surface/parents[8]");
  refuse([](auto& c) { c.surface.positions[2].y() = NAN; }, "/surface/position[2]");
  refuse([](auto& c) { c.surface.vertex_end = {6, 17}; }, "/surface/vertex_end");
  refuse([](auto& c) { c.surface.base_triangles[1][0] = 9; }, "/surface/base_triangles[1]");
  refuse([](auto& c) { c.row_node = {4, 4}; }, "/green/row_node[1]");
  refuse([](auto& c) { c.column_node = {18}; }, "/green/column_node[0]");
  refuse([](auto& c) { c.column_node.clear(); }, "/green/column_node is empty");
  refuse([](auto& c) { c.volume.tetrahedra[0][3] = 19; }, "/volume/tetrahedra[0]");
  refuse([](auto& c) { c.volume_fixed.clear(); }, "/volume/fixed");
  refuse([](auto& c) { c.young = -1.0; }, "young");
  refuse([](auto& c) { c.poisson = 0.5; }, "poisson");
  refuse([](auto& c) { c.unit = "K/W"; }, "m/N, not 'K/W'");
  refuse([](auto& c) { c.components = 2; }, "2 components");
  refuse([](auto& c) { c.components = 1; }, "young and poisson of a scalar problem must be 0");
  refuse(
      [](auto& c) {
        c = scalar_contents(3);
        c.unit.clear();
      },
      "the unit of a scalar problem");
}

/// Replaces a dataset by one of another shape or unit.
void replace(const std::filesystem::path& path, const std::string& dataset, const Hdf5Shape& shape, double value,
             const std::string& unit) {
  {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    REQUIRE(H5Ldelete(file.get(), dataset.c_str(), H5P_DEFAULT) >= 0);
  }
  if (shape.empty()) return;
  auto file = Hdf5File::open(path, true);
  std::size_t count = 1;
  for (const auto extent : shape) count *= extent;
  file.write(dataset, shape, std::vector<double>(count, value));
  if (!unit.empty()) file.write_text(dataset, "unit", unit);
}

TEST_CASE("a store made elsewhere is checked: missing datasets, wrong shapes, units, kinds, values") {
  const TemporaryFile file("foreign.h5");
  const auto refuse = [&](const std::string& dataset, const Hdf5Shape& shape, double value, const std::string& unit,
                          const char* reason) {
    { auto store = GreenStore::create(file.path, small_contents(3)); }
    replace(file.path, dataset, shape, value, unit);
    CAPTURE(dataset);
    std::string message;
    try {
      (void)GreenStore::open(file.path, Access::kReadOnly);
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    CHECK(message.find(file.path.string()) == 0);
    CHECK(message.find(dataset) != std::string::npos);
    CHECK(message.find(reason) != std::string::npos);
  };
  refuse("/surface/position", {}, 0, "", "missing");
  refuse("/surface/position", {18, 2}, 0.5, "m", "shape");
  refuse("/surface/position", {18, 3}, 0.5, "mm", "convert it to 'm'");
  refuse("/surface/position", {18, 3}, NAN, "m", "not finite");
  refuse("/surface/area", {17}, 0.5, "m^2", "needs 18");
  refuse("/surface/area", {18}, 0.5, "", "unit");
  refuse("/green/row_node", {17}, 0.5, "", "integers");
  refuse("/green/displacement", {}, 0, "", "missing");
  refuse("/green/displacement", {3, 3, 18, 3}, 0, "m/N", "shape must be [3, 3, 17, 3]");
  refuse("/green/displacement", {3, 3, 17, 3}, 0, "m", "convert it to 'm/N'");
  refuse("/green/displacement", {3, 1, 17, 3}, 0, "m/N", "shape must be [3, 3, 17, 3]");
  refuse("/green/displacement", {3, 1, 16, 1}, 0, "K/W", "shape must be [3, 1, 17, 1]");
  refuse("/green/displacement", {3, 1, 17, 1}, 0, "", "unit");
  refuse("/green/done", {}, 0, "", "missing");
  refuse("/volume/interpolation/weight", {17}, 1, "", "needs 18 entries");
}

TEST_CASE("columns that are not finite are refused when read") {
  const TemporaryFile file("nan.h5");
  {
    auto store = GreenStore::create(file.path, small_contents(3));
    store.write_columns(0, column_values(0, 17));
  }
  replace(file.path, "/green/displacement", {3, 3, 17, 3}, NAN, "m/N");
  const auto store = GreenStore::open(file.path, Access::kReadOnly);
  CHECK_THROWS_WITH((void)store.read_columns(0, 1), doctest::Contains("not finite"));
}

TEST_CASE("files that are no stores are refused") {
  const TemporaryFile file("text.h5");
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly), doctest::Contains("no such file"));
  std::ofstream(file.path) << "not an HDF5 file";
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly), doctest::Contains("no HDF5 file"));
  { auto empty = Hdf5File::create(file.path); }
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly), doctest::Contains("'format' is missing"));
}

/// Writes column after column, telling each through the pipe, until it is killed.
[[noreturn]] void write_until_killed(const std::filesystem::path& path, int pipe_end) {
  auto store = GreenStore::open(path, Access::kReadWrite);
  const int rows = store.row_count();
  for (const int column : store.missing_columns()) {
    store.write_columns(column, column_values(column, rows, store.contents().components));
    const char written = 1;
    if (write(pipe_end, &written, 1) != 1) _exit(1);
  }
  pause();
  _exit(0);
}

void kill_after_columns(const std::filesystem::path& path, int columns) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) write_until_killed(path, ends[1]);
  char byte = 0;
  for (int c = 0; c < columns; ++c) REQUIRE(read(ends[0], &byte, 1) == 1);
  REQUIRE(kill(child, SIGKILL) == 0);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  close(ends[0]);
  close(ends[1]);
}

void check_killed_and_resumed(const GreenStoreContents& contents) {
  const TemporaryFile file("killed.h5");
  const int components = contents.components, columns_in_all = static_cast<int>(contents.column_node.size());
  { auto store = GreenStore::create(file.path, contents); }
  int before = 0;
  for (const int columns : {1, 4, 2, 3, 1}) {
    kill_after_columns(file.path, std::min(columns, columns_in_all - before));
    const auto store = GreenStore::open(file.path, Access::kReadOnly);
    const int done = columns_in_all - static_cast<int>(store.missing_columns().size());
    CHECK(done >= std::min(before + columns, columns_in_all));
    for (int c = 0; c < done; ++c) CHECK(store.read_columns(c, 1) == column_values(c, 17, components));
    before = done;
    if (done == columns_in_all) break;
  }
  auto store = GreenStore::open(file.path, Access::kReadWrite);
  for (const int c : store.missing_columns()) store.write_columns(c, column_values(c, 17, components));
  CHECK(store.missing_columns().empty());
  for (int c = 0; c < columns_in_all; ++c) CHECK(store.read_columns(c, 1) == column_values(c, 17, components));
}

TEST_CASE("a writer killed at any time leaves a store that opens, with true columns, and is resumed") {
  check_killed_and_resumed(small_contents(18));
  check_killed_and_resumed(scalar_contents(18));
}

}  // namespace
}  // namespace greenloop
