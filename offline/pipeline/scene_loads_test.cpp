// What a scene's loads do, from the scene to the model file: a block that stands on its fixed base.

#include "offline/pipeline/scene_loads.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "formats/mesh/volume_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/mask.hpp"
#include "runtime/surface.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double young = 2e4, height = 0.08, side = 0.04, density = 1100;

// builds of one block with one store
class Block {
 public:
  Block() { write_volume(folder_.path() / "block.mesh", testing::box({4, 4, 8}, {side, side, height})); }

  std::filesystem::path build(const std::string& name, const std::string& more) {
    std::ofstream(folder_.path() / "block.toml")
        << "[volume]\nfile = \"block.mesh\"\nunit = \"m\"\n[remesh]\nlevels = 1\n"
           "[material]\nyoung = \"20 kPa\"\npoisson = 0.0\ndensity = \"1.1 kg/l\"\n"
           "[solve]\nelements = \"quadratic\"\n[[fixed]]\nbelow = 0\naxis = \"z\"\n"
           "[compression]\nwavelet = \"equilibrated\"\n"
        << more;
    ProgressBar quiet(true);
    auto model = folder_.path() / name;
    record_ = build_model_file(
                  {.scene = folder_.path() / "block.toml", .model = model, .store = folder_.path() / "block.h5"}, quiet)
                  .record;
    return model;
  }

  [[nodiscard]] const nlohmann::json& record() const { return record_; }
  [[nodiscard]] std::filesystem::path store() const { return folder_.path() / "block.h5"; }

 private:
  TemporaryFolder folder_{"scene_loads_test"};
  nlohmann::json record_;
};

struct Moved {
  Vector3d position, displacement;
};

// the domain nodes under one unit of a load
std::vector<Moved> moved_nodes(const ModelView& view, std::uint32_t load) {
  const SurfaceWavelet wavelet(view);
  std::vector<double> x;
  std::vector<Moved> nodes;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    x.insert(x.end(), level.load_column(load), level.load_column(load) + std::size_t{3} * level.counts->domain_count);
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      nodes.push_back({Eigen::Map<const Eigen::Vector3f>(level.nodes[i].position).cast<double>(), Vector3d::Zero()});
    }
  }
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) wavelet.merge(level, 3, x.data());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].displacement = Eigen::Map<const Vector3d>(x.data() + 3 * i);
  return nodes;
}

TEST_CASE("a block under its own weight, and under a pressure on its top, shortens as a column does") {
  Block block;
  const ModelFile model = open_model_file(
      block.build("block.gloop", "[[loads]]\ngravity = true\n[[loads]]\nname = \"top\"\nabove = 1\naxis = \"z\"\n"));
  const ModelView& view = model.view;
  REQUIRE(view.has_gravity());
  REQUIRE(view.loads.size() == 4);
  const double mass = density * side * side * height;
  for (std::uint32_t load = 0; load < 3; ++load) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      CHECK(view.loads[load].resultant[k] == doctest::Approx(load == k ? mass : 0));
    }
  }
  CHECK(std::string(view.loads[3].name) == "top");
  CHECK(view.loads[3].resultant[2] == doctest::Approx(-side * side));
  CHECK(std::abs(view.loads[3].resultant[0]) < 1e-6 * side * side);

  constexpr double weight = density * 9.81;  // N/m^3
  const double shortened = weight * height * height / (2 * young);
  double worst = 0;
  for (const auto& [x, u] : moved_nodes(view, 2)) {
    const double z = x.z();
    const Vector3d expected(0, 0, -weight * (height * z - z * z / 2) / young);
    worst = std::max(worst, (-9.81 * u - expected).norm() / shortened);
  }
  MESSAGE("deviation from the column under its own weight: " << 100 * worst << " %");
  CHECK(worst < 0.02);

  constexpr double pascals = 100;
  double worst_pressed = 0;
  for (const auto& [x, u] : moved_nodes(view, 3)) {
    if (x.z() > 0.8 * height) continue;  // beside the loaded nodes
    worst_pressed = std::max(worst_pressed, std::abs(pascals * u.z() + pascals * x.z() / young));
  }
  MESSAGE("deviation from the pressed column: " << 100 * worst_pressed / (pascals * height / young) << " %");
  CHECK(worst_pressed < 0.02 * pascals * height / young);
}

// what finite elements say of gravity, m, three numbers a domain node
Eigen::VectorXd solved_gravity(const GreenStore& store, const Vector3d& gravity) {
  return density * store.read_body_force() * gravity;
}

TEST_CASE("a body that is tilted in the loop bends as finite elements say, and weighs on what holds it") {
  Block block;
  const ModelFile file = open_model_file(block.build("block.gloop", "[[loads]]\ngravity = true\n"));
  const Model model = Model::open(file.bytes.span()).model;
  const GreenStore store = GreenStore::open(block.store(), GreenStore::Access::kReadOnly);
  const std::vector<int>& nodes = store.contents().row_node;
  const auto limits = Elastostatic::intended(model).limits;
  REQUIRE(limits.model_loads);
  Hosted<Elastostatic> body(model, limits);
  double largest = 0;
  for (int step = 0; step <= 24; ++step) {  // through half a turn about an oblique axis
    const Vector3d gravity =
        Eigen::AngleAxisd(M_PI * step / 24, Vector3d(1, 2, 0).normalized()) * Vector3d(0, 0, -9.81);
    const Elastostatic::Loads loads{
        .gravity = {static_cast<float>(gravity.x()), static_cast<float>(gravity.y()), static_cast<float>(gravity.z())}};
    REQUIRE(body.step({}, loads, any_budget, true).status == Status::ok);
    const Eigen::VectorXd expected = solved_gravity(store, gravity);
    for (std::size_t r = 0; r < nodes.size(); ++r) {
      const Eigen::Vector3f found = Eigen::Map<const Eigen::Vector3f>(body.field().data() + std::size_t{4} * nodes[r]);
      const Vector3d error = found.cast<double>() - expected.segment<3>(3 * static_cast<Eigen::Index>(r));
      largest = std::max(largest, error.norm() / expected.cwiseAbs().maxCoeff());
    }
  }
  MESSAGE("largest deviation of a field from finite elements, of its largest component: " << largest);
  CHECK(largest < 2e-6);

  // a finger that stays where the top was while the block lies on its side
  const Vector3d sideways(9.81, 0, 0);
  const auto top = std::max_element(nodes.begin(), nodes.end(), [&](int a, int b) {
    return store.contents().surface.positions[a].z() < store.contents().surface.positions[b].z();
  });
  const auto row = static_cast<int>(top - nodes.begin());
  const std::vector<Constraint> finger = {{static_cast<std::uint32_t>(*top), {}}};
  const Elastostatic::Loads loads{.gravity = {9.81F, 0, 0}};
  REQUIRE(body.step(finger, loads, any_budget, true).status == Status::ok);
  const Eigen::Matrix3d compliance = store.read_block(row, 1, row, 1);
  const Vector3d expected = -compliance.inverse() * solved_gravity(store, sideways).segment<3>(Eigen::Index{3} * row);
  const Vector3d force(body.force()[0], body.force()[1], body.force()[2]);
  MESSAGE("force of the finger, against finite elements: " << 100 * (force - expected).norm() / expected.norm()
                                                           << " %");
  CHECK((force - expected).norm() < 0.05 * expected.norm());
  CHECK(force.x() < 0);
}

TEST_CASE("loads that are asked for later solve no column again, and leave the couplings as they are") {
  Block block;
  const ModelFile without = open_model_file(block.build("without.gloop", ""));
  CHECK(block.record()["solve"]["columns_solved"] > 0);
  CHECK(without.view.loads.empty());
  CHECK(without.view.header->minor < 6);
  const ModelFile with = open_model_file(block.build("with.gloop", "[[loads]]\ngravity = true\n"));
  CHECK(block.record()["solve"]["columns_solved"] == 0);
  REQUIRE(with.view.has_gravity());
  CHECK(with.view.header->section_count == without.view.header->section_count + 1 + with.view.levels);
  for (std::uint32_t q = 0; q < with.view.levels; ++q) {
    CHECK(with.view.level[q].counts->kept_blocks == without.view.level[q].counts->kept_blocks);
  }
}

TEST_CASE("a pressure whose region holds no triangle is refused by name") {
  Block block;
  CHECK_THROWS_WITH_AS(
      (void)block.build("none.gloop", "[[loads]]\nname = \"edge\"\nbox = [[0, 0, 0.2], [0, 0, 1]]\n"),
      doctest::Contains("loads: \"edge\": no triangle of the surface has its three corners in the region"),
      std::runtime_error);
}

TEST_CASE("pressures along a vector and along the normals have the resultants of the surface that they act on") {
  Block block;
  (void)block.build("block.gloop", "");
  Scene scene;
  const auto box = [](const Vector3d& low, const Vector3d& high) { return BoxRegion{low, high}; };
  scene.pressures = {{"sideways", HalfSpace{2, false, 1}, Vector3d(3, 0, -4)},
                     {"around", box({0, 0, 0}, {1, 1, 1}), std::nullopt}};
  auto store = GreenStore::open(block.store(), GreenStore::Access::kReadOnly);
  const LoadDisplacements loads = load_displacements(scene, store);
  REQUIRE(loads.records.size() == 2);
  CHECK(loads.records[0].resultant[0] == doctest::Approx(0.6 * side * side));
  CHECK(loads.records[0].resultant[2] == doctest::Approx(-0.8 * side * side));
  for (const float force : loads.records[1].resultant) CHECK(std::abs(force) < 1e-6 * side * side);
  CHECK(loads.displacement.col(0).norm() > 0);
}

TEST_CASE("a mask of the scene presses as the same mask does that is made at run time") {
  Block block;
  const ModelFile file = open_model_file(block.build(
      "finger.gloop",
      "[[loads]]\nname = \"finger\"\nmask = true\nsphere = { center = [0.5, 0.5, 1], radius = \"1.8 cm\" }\n"));
  const Model model = Model::open(file.bytes.span()).model;
  REQUIRE(file.view.loads.size() == 1);
  const float newtons = file.view.loads[0].resultant[2];  // a pascal
  auto limits = Elastostatic::intended(model).limits;
  limits.max_forces = model.node_count();
  Hosted<Elastostatic> body(model, limits);
  constexpr float pascals = 100;
  Elastostatic::Loads loads;
  loads.pressure = {&pascals, 1};
  REQUIRE(body.step({}, loads, any_budget, true).status == Status::ok);
  const std::vector<float> stored(body.field().begin(), body.field().end());

  const std::uint32_t finest = model.level_count() - 1;
  AlignedBytes memory(Surface::required(model, finest).bytes);
  const auto surface = Surface::create(model, finest, {memory.data(), memory.size()});
  REQUIRE(surface);
  std::vector<float> weight(model.node_count());
  const auto away = [&](std::uint32_t node) {
    const Vec3 x = model.position(node);
    return Vector3d(x.x - side / 2, x.y - side / 2, x.z - height).norm();
  };
  std::uint32_t middle = 0;  // of the top
  for (std::uint32_t node = 1; node < model.node_count(); ++node) middle = away(node) < away(middle) ? node : middle;
  std::vector<std::uint32_t> node(model.node_count());
  const Mask mask = make_mask(surface.surface, finest, at_node(middle), 0.018F, node, weight);
  REQUIRE(mask.node.size() > 4);
  const std::vector<Constraint> force = {{0, {0, 0, pascals * newtons}, Constraint::Kind::pattern}};
  loads = {};
  loads.masks = {&mask, 1};
  REQUIRE(body.step(force, loads, any_budget, true).status == Status::ok);
  float worst = 0, largest = 0;
  for (std::uint32_t i = 0; i < model.node_count(); ++i) {
    const std::size_t z = std::size_t{4} * i + 2;
    worst = std::max(worst, std::fabs(stored[z] - body.field()[z]));
    largest = std::max(largest, std::fabs(body.field()[z]));
  }
  MESSAGE("a stored mask beside one that is made: " << 100 * worst / largest << " % of the largest displacement");
  CHECK(worst < 0.02F * largest);
}

}  // namespace
}  // namespace greenloop::offline
