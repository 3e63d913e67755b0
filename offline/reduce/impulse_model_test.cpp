#include "offline/reduce/impulse_model.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "formats/testing/temporary_folder.hpp"
#include "offline/reduce/mode_quantisation.hpp"
#include "offline/reduce/replay.hpp"
#include "offline/reduce/testing/damped_sheet.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;

const auto silent = [](double) {};

/// A sheet's trajectories, reduced, for tests.
struct Sheet {
  explicit Sheet(const DampedSheet& sheet, double truncation = 0.01)
      : folder("reduce-" + std::to_string(sheet.orbits)), path(folder.path() / "sheet.h5") {
    write_sheet(path, sheet);
    goal.reduction.truncation = truncation;
  }
  [[nodiscard]] TrajectoryFile file() const { return TrajectoryFile::open(path); }

  TemporaryFolder folder;
  std::filesystem::path path;
  ImpulseModelGoal goal;
};

std::vector<FrameRange> all_frames(const TrajectoryScene& scene) {
  std::vector<FrameRange> ranges;
  for (const auto& orbit : scene.orbits) ranges.push_back({orbit.first_frame, orbit.frames});
  return joined_ranges(ranges);
}

TEST_CASE("reduction: frames are their modes, shape and what is left out") {
  const Sheet sheet({.orbits = 6}, 0.05);
  const auto file = sheet.file();
  const auto reduced = reduce_frames(file, all_frames(file.scene()), sheet.goal.reduction, silent);
  const auto size = static_cast<Index>(file.scene().rest.size());
  CHECK(reduced.modes.cols() % 2 == 0);
  CHECK(reduced.modes.cols() < 20);
  double worst = 0;
  std::vector<float> frame(file.scene().rest.size());
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{30}, std::uint64_t{200}}) {
    file.read_frames(number, 1, frame);
    const Index column = reduced.column(number);
    Eigen::VectorXd left = Eigen::Map<const Eigen::VectorXf>(frame.data(), size).cast<double>() -
                           Eigen::Map<const Eigen::VectorXf>(reduced.shape.data(), size).cast<double>();
    left -= reduced.modes.cast<double>() * reduced.coordinates.col(column);
    const double said = reduced.left_out[static_cast<std::size_t>(column)];
    worst = std::max(worst, std::abs(left.norm() - std::sqrt(said)) / (std::sqrt(said) + 1e-4));
  }
  CHECK(worst < 0.1);  // what is unread and the modes left out are added as if they were orthogonal
  const auto& sigma = reduced.singular_values;
  CHECK(std::is_sorted(sigma.rbegin(), sigma.rend()));
  CHECK(sigma[static_cast<std::size_t>(reduced.modes.cols())] < 0.05 * sigma[0]);
  CHECK(reduced.unread <= 0.005 * sigma[0]);
  CHECK_THROWS_AS((void)reduced.column(file.frames()), std::out_of_range);

  const auto projected = project_frames(file, {{10, 20}}, reduced);
  const auto same = reduced.coordinates.middleCols(reduced.column(10), 20);
  CHECK((projected.coordinates - same).norm() < 0.01 * same.norm());
}

TEST_CASE("reduction: a memory that is too small is refused before anything is read") {
  const Sheet sheet({.orbits = 2});
  ReductionGoal goal;
  goal.memory = 1U << 20U;
  CHECK_THROWS_AS((void)reduce_frames(sheet.file(), {{0, 50}}, goal, silent), std::runtime_error);
}

/// Plays an orbit until it rests, as it must where an orbit of its impulse does, or comes round.
void check_never_dies(const PhasePortrait& portrait, std::size_t orbit) {
  bool must_rest = false;
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) {
    must_rest = must_rest || (portrait.at_rest[k] && portrait.orbits[k].impulse == portrait.orbits[orbit].impulse);
  }
  std::set<std::size_t> seen;
  while (portrait.orbits[orbit].next_orbit != layout::none) {
    const auto& from = portrait.orbits[orbit];
    const auto& to = portrait.orbits[from.next_orbit];
    REQUIRE(to.impulse == from.impulse);
    REQUIRE(from.next_row > to.first_row);
    REQUIRE(from.next_row + 1 < to.first_row + to.rows);
    CHECK(from.next_distance == doctest::Approx(std::sqrt(portrait.squared_distance(
                                    Index{from.first_row} + from.rows - 1, Index{from.next_row}))));
    if (!seen.insert(orbit).second) break;
    orbit = from.next_orbit;
  }
  if (must_rest) CHECK(portrait.at_rest[orbit]);
}

TEST_CASE("phase portrait: rows, velocities, continuations and the nearest references") {
  const Sheet sheet({.orbits = 12});
  const auto file = sheet.file();
  const auto& scene = file.scene();
  const auto reduced = reduce_frames(file, all_frames(scene), sheet.goal.reduction, silent);
  auto portrait = phase_portrait(scene, reduced);
  REQUIRE(portrait.orbits.size() == 13);
  CHECK(portrait.orbits[0].rows == 2);
  CHECK(portrait.position.col(1) == reduced.rest);
  const auto& orbit = portrait.orbits[3];
  CHECK(orbit.rows == scene.orbits[2].frames + 1);
  const Index row = Index{orbit.first_row} + 5;
  CHECK(portrait.position.col(row) == reduced.coordinates.col(reduced.column(scene.orbits[2].first_frame + 4)));
  const Eigen::VectorXd velocity = (portrait.position.col(row) - portrait.position.col(row - 1)) / scene.time_step;
  CHECK((portrait.velocity.col(row) - velocity).norm() == 0);

  CHECK(continue_orbits(scene.impulses, 1e9, portrait).empty());
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) check_never_dies(portrait, k);

  auto successions = scene.successions;
  successions[0 * 3 + 1] = 0;  // down may not follow up
  const auto references = nearest_references(portrait, successions, 3);
  for (std::size_t k = 0; k < portrait.orbits.size(); ++k) {
    const auto& from = portrait.orbits[k];
    const auto& found = references[(from.first_row + 1) * 3 + 1];
    if (from.impulse == 0) {
      CHECK(found.orbit == layout::none);
      CHECK(found.distance == 0);
      continue;
    }
    REQUIRE(portrait.orbits[found.orbit].impulse == 1);
    for (const auto& other : portrait.orbits) {
      if (other.impulse != 1) continue;
      const double distance = std::sqrt(portrait.squared_distance(from.first_row + 1, Index{other.first_row} + 1));
      CHECK(found.distance <= static_cast<float>(distance) * 1.000001F);
    }
    if (from.impulse == 1) CHECK(found.distance == 0);  // its own start
  }
}

TEST_CASE("phase portrait: orbits that never rest go on in circles, dead ends are taken out") {
  const Sheet sheet({.orbits = 12, .comes_to_rest = false});
  const auto file = sheet.file();
  const auto reduced = reduce_frames(file, all_frames(file.scene()), sheet.goal.reduction, silent);
  const auto whole = phase_portrait(file.scene(), reduced);
  auto portrait = whole;
  CHECK(continue_orbits(file.scene().impulses, 1e9, portrait).empty());
  std::vector<double> distances;
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) {
    check_never_dies(portrait, k);
    distances.push_back(portrait.orbits[k].next_distance);
  }
  const double limit = 0.99 * *std::max_element(distances.begin(), distances.end());
  auto pruned = whole;
  const auto dead_ends = continue_orbits(file.scene().impulses, limit, pruned);
  REQUIRE(!dead_ends.empty());
  CHECK(pruned.orbits.size() + dead_ends.size() == whole.orbits.size());
  for (const DeadEnd& end : dead_ends) CHECK(end.distance > limit);
  for (std::size_t k = 1; k < pruned.orbits.size(); ++k) {
    check_never_dies(pruned, k);
    CHECK(pruned.orbits[k].next_distance <= limit);
    const auto source = pruned.source_orbit[k] + 1;  // orbit 0 is the scene at rest
    CHECK(pruned.position.col(pruned.orbits[k].first_row) == whole.position.col(whole.orbits[source].first_row));
  }
  auto none_left = whole;
  CHECK_THROWS_AS((void)continue_orbits(file.scene().impulses, 1e-9, none_left), std::runtime_error);
}

TEST_CASE("quantisation: the measured error is that of the displacements, and 16 bits follow where 8 do not do") {
  const Eigen::MatrixXf modes = Eigen::MatrixXf::Random(99, 6);
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(6, 40);
  double error_of_8 = 0;
  for (const std::uint32_t planes : {1U, 2U}) {
    CAPTURE(planes);
    const auto quantised = quantise(modes, rows, planes);
    double sum = 0;
    for (Index row = 0; row < rows.cols(); ++row) {
      const Eigen::VectorXd exact = modes.cast<double>() * rows.col(row);
      for (Index v = 0; v < modes.rows(); ++v) {
        double value = 0;
        for (Index m = 0; m < 6; ++m) {
          value += quantised.values[static_cast<std::size_t>(v * 6 + m)] *
                   (quantised.coordinates[static_cast<std::size_t>(row * 6 + m)] / 32767.0);
        }
        sum += std::pow(exact[v] - value * double{quantised.quanta[static_cast<std::size_t>(v / 48)]}, 2);
      }
    }
    CHECK(quantised.error == doctest::Approx(std::sqrt(sum)).epsilon(1e-3));
    if (planes == 1) error_of_8 = quantised.error;
  }
  CHECK(quantise_within(modes, rows, 1.01 * error_of_8).planes == 1);
  CHECK(quantise_within(modes, rows, 0.99 * error_of_8).planes == 2);
  CHECK_THROWS_AS((void)quantise_within(modes, rows, 1e-9), std::runtime_error);
}

TEST_CASE("impulse model: a verified file whose errors are within what was asked") {
  const Sheet sheet({.orbits = 18, .held_out = 6}, 0.01);
  auto model = build_impulse_model(sheet.file(), sheet.goal, silent);
  model.data.provenance = "{}";
  const ModelFile file = encoded_file(model.data);
  const auto& view = file.view.impulse_response;
  CHECK(view.info->quantisation_error <= 0.01F);
  CHECK(view.group[view.levels - 1].counts->truncation_error < 0.03F);
  CHECK(view.info->orbits == 19);
  CHECK(view.info->blend_rate > 0);
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    CHECK(view.group[q].counts->truncation_error <= view.group[q - 1].counts->truncation_error);
  }
  REQUIRE(model.replay_errors.size() == 6);
  CHECK(std::is_sorted(model.replay_errors.begin(), model.replay_errors.end()));

  auto exact = sheet.goal;
  exact.reduction.truncation = 0.001;
  exact.quantisation = 1e-4;
  const auto finer = build_impulse_model(sheet.file(), exact, silent);
  CHECK(finer.data.info.planes == 2);
  CHECK(finer.data.groups.back().counts.truncation_error < model.data.groups.back().counts.truncation_error);
}

TEST_CASE("replay: an orbit that the model holds is replayed exactly, others the better the more there are") {
  const Sheet few({.orbits = 6, .held_out = 12, .seed = 3}), many({.orbits = 60, .held_out = 12, .seed = 3});
  const auto error = [](const Sheet& sheet) {
    return quantile(build_impulse_model(sheet.file(), sheet.goal, silent).replay_errors, 0.5);
  };
  const double of_few = error(few), of_many = error(many);
  CAPTURE(of_few);
  CAPTURE(of_many);
  CHECK(of_many < of_few);

  // the same orbit held out and built from
  const TemporaryFolder folder("replay");
  const auto path = folder.path() / "twice.h5";
  const auto file = few.file();
  const TrajectoryOrbit orbit = file.scene().orbits[0];
  auto scene = file.scene();
  scene.orbits.clear();
  scene.impulses.resize(1);
  scene.successions = {1, 1};
  auto writer = TrajectoryWriter::create(path, scene, {.frames = 2 * orbit.frames, .orbits = 2});
  std::vector<float> frame(scene.rest.size());
  for (const bool held_out : {false, true}) {
    writer.begin_orbit(0, -1, held_out);
    for (std::uint64_t k = 0; k < orbit.frames; ++k) {
      file.read_frames(orbit.first_frame + k, 1, frame);
      writer.add_frame(frame);
    }
    writer.end_orbit(true);
  }
  writer.close();
  auto goal = few.goal;
  goal.reduction.truncation = 1e-4;
  goal.quantisation = 1e-3;
  CHECK(build_impulse_model(TrajectoryFile::open(path), goal, silent).replay_errors.at(0) < 1e-3);
}

}  // namespace
}  // namespace greenloop::offline
