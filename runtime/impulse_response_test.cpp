// Motions against the same played in double precision from the file's numbers, and what a loop may rely on.

#include "runtime/impulse_response.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/greenloop_impulse.h"
#include "runtime/hosted/hosted.hpp"

namespace greenloop {
namespace {

using layout::none;
constexpr std::uint32_t no_impulse = ImpulseResponse::no_impulse;

struct Opened {
  explicit Opened(const SyntheticMotion& options) : file(encoded_file(synthetic_motion(options))) {
    auto opened = Model::open(file.bytes.span());
    REQUIRE(opened);
    model = opened.model;
  }
  [[nodiscard]] const ImpulseResponseView& view() const { return model.view().impulse_response; }

  ModelFile file;
  Model model;
};

// A body with buffers for all that it can answer.
struct Played {
  explicit Played(const Opened& opened, const ImpulseResponse::Limits& limits = {})
      : need(ImpulseResponse::required(opened.model, limits)),
        arena(need.bytes),
        coordinate(opened.view().modes),
        velocity(opened.view().modes),
        displacement(opened.view().info->vertices),
        rate(opened.view().info->vertices) {
    const auto created = ImpulseResponse::create(opened.model, limits, {arena.data(), arena.size()});
    REQUIRE(created);
    body = created.body;
  }

  [[nodiscard]] ImpulseResponse::Response all() { return {coordinate, velocity, displacement, rate}; }
  [[nodiscard]] ImpulseResponse::Response states() { return {coordinate, velocity, {}, {}}; }
  ImpulseResponse::StepReport step(std::uint32_t impulse = no_impulse) {
    return body.step(impulse, {any_budget}, all());
  }

  ImpulseResponse::Requirement need;
  AlignedBytes arena;
  std::vector<float> coordinate, velocity;
  std::vector<Vec3> displacement, rate;
  ImpulseResponse body;
};

// The kernel's mathematics in double precision, plainly.
class Reference {
 public:
  Reference(const ImpulseResponseView& view, double steps, double decay)
      : view_(view), steps_(steps), decay_(decay), offset_(view.modes), rate_offset_(view.modes) {}

  void enter(std::uint32_t orbit) {
    const auto now = position(), moving = velocity();
    orbit_ = orbit;
    at_ = view_.orbits[orbit].first_row + 1;
    for (std::uint32_t m = 0; m < view_.modes; ++m) {
      offset_[m] = now[m] - row(at_, m);
      rate_offset_[m] = moving[m] - row_rate(at_, m);
    }
  }

  void pass() {
    for (double& x : offset_) x *= decay_;
    for (double& x : rate_offset_) x *= decay_;
    at_ += steps_;
    while (true) {
      const layout::OrbitRecord& orbit = view_.orbits[orbit_];
      const double last = orbit.first_row + orbit.rows - 1;
      if (at_ < last) return;
      if (orbit.next_orbit == none) {
        at_ = last;
        return;
      }
      for (std::uint32_t m = 0; m < view_.modes; ++m) {
        offset_[m] += row(last, m) - row(orbit.next_row, m);
        rate_offset_[m] += row_rate(last, m) - row_rate(orbit.next_row, m);
      }
      at_ += orbit.next_row - last;
      orbit_ = orbit.next_orbit;
    }
  }

  [[nodiscard]] std::vector<double> position() const {
    std::vector<double> x = offset_;
    for (std::uint32_t m = 0; m < view_.modes; ++m) x[m] += row(at_, m);
    return x;
  }
  [[nodiscard]] std::vector<double> velocity() const {
    std::vector<double> v = rate_offset_;
    const double phase = at_ - std::floor(at_);
    for (std::uint32_t m = 0; m < view_.modes; ++m) {
      v[m] += (1 - phase) * row_rate(std::floor(at_), m);
      if (phase > 0) v[m] += phase * row_rate(std::floor(at_) + 1, m);
    }
    return v;
  }
  [[nodiscard]] std::uint32_t orbit() const { return orbit_; }
  [[nodiscard]] std::uint32_t row() const { return static_cast<std::uint32_t>(at_); }

 private:
  [[nodiscard]] double stored(std::uint32_t row, std::uint32_t mode) const {
    std::uint32_t q = 0;
    while (mode >= view_.group[q].counts->modes) mode -= view_.group[q++].counts->modes;
    return view_.group[q].coordinates[std::size_t{row} * view_.group[q].counts->modes + mode] / 32767.0;
  }
  [[nodiscard]] double row(double at, std::uint32_t mode) const {
    const auto first = static_cast<std::uint32_t>(at);
    const double phase = at - first;
    return phase == 0 ? stored(first, mode) : (1 - phase) * stored(first, mode) + phase * stored(first + 1, mode);
  }
  [[nodiscard]] double row_rate(double at, std::uint32_t mode) const {
    const layout::OrbitRecord& orbit = view_.orbits[orbit_];
    const auto row = static_cast<std::uint32_t>(at);
    if (orbit.next_orbit == none && row == orbit.first_row + orbit.rows - 1) return 0;
    return (stored(row, mode) - stored(row - 1, mode)) / view_.info->time_step;
  }

  const ImpulseResponseView& view_;
  double steps_, decay_;
  std::uint32_t orbit_ = 0;
  double at_ = 1;
  std::vector<double> offset_, rate_offset_;
};

double amplitude(const ImpulseResponseView& view, std::uint32_t mode) {
  std::uint32_t q = 0;
  while (mode >= view.group[q].counts->modes) mode -= view.group[q++].counts->modes;
  return static_cast<double>(view.group[q].amplitudes[mode].amplitude);
}

// the displacement of component v of the vertices, from the file's numbers
double displaced(const ImpulseResponseView& view, const std::vector<double>& c, std::uint32_t v, std::uint32_t modes) {
  double sum = 0;
  std::uint32_t mode = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const std::uint32_t pairs = view.group[q].counts->modes / 2;
    for (std::uint32_t m = 0; m < 2 * pairs && mode < modes; ++m, ++mode) {
      const std::size_t at = 2 * ((std::size_t{v} / 48 * pairs + m / 2) * 48 + v % 48) + m % 2;
      const int value = view.info->planes == 1 ? view.group[q].plane[0][at]
                                               : 256 * view.group[q].plane[0][at] + view.group[q].plane[1][at];
      sum += value * c[mode];
    }
  }
  return sum * static_cast<double>(view.quanta[v / 48]);
}

std::uint32_t random_impulse(const Played& played, std::mt19937& random, std::uint32_t impulses, double chance) {
  if (std::uniform_real_distribution<>(0, 1)(random) > chance) return no_impulse;
  const auto impulse = static_cast<std::uint32_t>(random() % impulses);
  return played.body.may_follow(impulse) ? impulse : no_impulse;
}

// the orbit that an impulse leads to from where the reference is
std::uint32_t led_to(const ImpulseResponseView& view, const Reference& reference, std::uint32_t impulse) {
  return view.references[std::size_t{reference.row()} * view.info->impulses + impulse].orbit;
}

TEST_CASE("states are those of the paper's playback and blending in double precision, at any rate of the loop") {
  for (const float rate : {1000.0F, 128.0F, 60.0F, 9.0F}) {
    CAPTURE(rate);
    const Opened opened({.alternating = true});
    const ImpulseResponseView& view = opened.view();
    Played played(opened, {.rate = rate});
    const double period = 1.0 / static_cast<double>(rate);
    // time counts in 2^-32 of the model's steps
    const double steps = std::floor(period / view.info->time_step * 0x1p32) * 0x1p-32;
    Reference reference(view, steps, std::exp(-static_cast<double>(view.info->blend_rate) * period));
    std::mt19937 random(1);
    double worst = 0, worst_rate = 0, largest_rate = 0;
    std::set<std::uint32_t> orbits;
    for (int k = 0; k < 4000; ++k) {
      const std::uint32_t impulse = random_impulse(played, random, 3, 0.02);
      if (impulse != no_impulse) reference.enter(led_to(view, reference, impulse));
      const auto report = played.step(impulse);
      REQUIRE(report.status == Status::ok);
      if (impulse != no_impulse) CHECK(report.impulse == impulse);
      reference.pass();
      REQUIRE(report.orbit == reference.orbit());
      REQUIRE(report.row == reference.row());
      orbits.insert(report.orbit);
      const auto x = reference.position(), v = reference.velocity();
      for (std::uint32_t m = 0; m < view.modes; ++m) {
        worst = std::max(worst, std::abs(static_cast<double>(played.coordinate[m]) / amplitude(view, m) - x[m]));
        worst_rate =
            std::max(worst_rate, std::abs(static_cast<double>(played.velocity[m]) / amplitude(view, m) - v[m]));
        largest_rate = std::max(largest_rate, std::abs(v[m]));
      }
    }
    CHECK(orbits.size() >= 5);
    CHECK(worst < 2e-6);
    CHECK(worst_rate < 2e-6 * largest_rate);
  }
}

TEST_CASE("displacements are the sums of the modes' stored values, of all vertices, of the first and of chosen ones") {
  for (const std::uint32_t planes : {1U, 2U}) {
    const Opened opened({.modes = 10, .groups = 3, .planes = planes});
    const ImpulseResponseView& view = opened.view();
    Played played(opened);
    std::mt19937 random(2);
    double worst = 0, largest = 0;
    for (int k = 0; k < 200; ++k) {
      REQUIRE(played.step(random_impulse(played, random, 3, 0.05)).status == Status::ok);
      std::vector<double> c(view.modes);
      for (std::uint32_t m = 0; m < view.modes; ++m)
        c[m] = static_cast<double>(played.coordinate[m]) / amplitude(view, m);
      for (std::uint32_t v = 0; v < 3 * view.info->vertices; ++v) {
        const Vec3& u = played.displacement[v / 3];
        const double found = static_cast<double>(v % 3 == 0 ? u.x : v % 3 == 1 ? u.y : u.z);
        const double expected = displaced(view, c, v, view.modes);
        worst = std::max(worst, std::abs(found - expected));
        largest = std::max(largest, std::abs(expected));
      }
    }
    CHECK(largest > 1e-3);
    CHECK(worst < 2e-4 * largest);  // coordinates of 16 bits, ten of them
  }
}

TEST_CASE("a vertex has the same displacement among all, among the first and chosen alone") {
  const Opened opened({.vertices = 90, .modes = 8, .groups = 4, .planes = 2});
  Played all(opened), first(opened), chosen(opened);
  const std::vector<std::uint32_t> numbers = {89, 0, 17, 17, 63};
  std::mt19937 random(3);
  for (int k = 0; k < 300; ++k) {
    const std::uint32_t impulse = random_impulse(all, random, 3, 0.05);
    all.step(impulse);
    std::vector<Vec3> some(21), five(numbers.size());
    REQUIRE(first.body.step(impulse, {any_budget}, {{}, {}, some, {}}).status == Status::ok);
    REQUIRE(chosen.body.step(impulse, {any_budget}, {{}, {}, five, {}, numbers}).status == Status::ok);
    CHECK(std::memcmp(some.data(), all.displacement.data(), some.size() * sizeof(Vec3)) == 0);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      CHECK(std::memcmp(&five[i], &all.displacement[numbers[i]], sizeof(Vec3)) == 0);
    }
  }
}

TEST_CASE("however many vertices are chosen, no step takes more than is declared") {
  const Opened opened({.modes = 12, .groups = 3, .planes = 2});
  std::set<Status> seen;
  for (std::size_t count = 1; count <= 100; ++count) {
    Played played(opened);
    std::vector<Vec3> some(count), rates(count);
    const auto report = played.body.step(1, {any_budget}, {{}, {}, some, rates, std::vector<std::uint32_t>(count, 50)});
    CHECK(report.work <= played.need.worst_work);
    seen.insert(report.status);
  }
  CHECK(seen == std::set<Status>{Status::ok, Status::coarser, Status::held_over_budget});
}

TEST_CASE("less budget means fewer modes, never more work than it holds, and the same states") {
  const Opened opened({.modes = 12, .groups = 3, .planes = 2});
  Played whole(opened);
  const ImpulseResponse::Requirement need = whole.need;
  CHECK(need.least_work < need.least_frame_work);
  CHECK(need.least_frame_work < need.frame_work);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::uint64_t work = need.least_work; work <= need.frame_work + 50; work += 40) {
    Played starved(opened);
    Played free_of_budget(opened);
    for (int k = 0; k < 5; ++k) {
      const std::uint32_t impulse = k == 0 ? 1 : no_impulse;
      const auto report =
          starved.body.step(impulse, {work}, {starved.coordinate, starved.velocity, starved.displacement, {}});
      if (work < need.least_frame_work) {
        REQUIRE(report.status == Status::held_over_budget);
        CHECK(starved.coordinate == std::vector<float>(12));
        continue;
      }
      free_of_budget.step(impulse);
      REQUIRE(answered(report.status));
      CHECK(report.work <= work);
      CHECK((report.status == Status::ok) == (report.modes == 12 && report.planes == 2));
      CHECK(starved.coordinate == free_of_budget.coordinate);
      CHECK(starved.velocity == free_of_budget.velocity);
      CHECK(report.truncation_error ==
            opened.view().group[(report.modes - 1) / 4].amplitudes[(report.modes - 1) % 4].truncation_error);
      seen.insert({report.modes, report.planes});
      // the sum of those modes
      std::vector<double> c(12);
      for (std::uint32_t m = 0; m < 12; ++m) {
        c[m] = static_cast<double>(starved.coordinate[m]) / amplitude(opened.view(), m);
      }
      const double expected = displaced(opened.view(), c, 3 * 40, report.modes);
      CHECK(static_cast<double>(starved.displacement[40].x) == doctest::Approx(expected).epsilon(0.02).scale(1e-3));
    }
  }
  CHECK(seen.size() == 7);  // 2 .. 12 modes with one plane, and all with both
}

TEST_CASE("what may not be is refused by name, and nothing moves or is written") {
  const Opened opened({.alternating = true});
  Played played(opened);
  played.step(0);
  for (int k = 0; k < 5; ++k) played.step();
  const std::vector<float> before = played.coordinate;
  const auto refused = [&](std::uint32_t impulse, Budget budget, const ImpulseResponse::Response& response,
                           Status why) {
    CHECK(played.body.step(impulse, budget, response).status == why);
    CHECK(played.coordinate == before);
  };
  const Budget all{any_budget};
  CHECK(!played.body.may_follow(0));
  CHECK(!played.body.may_follow(3));
  CHECK(!played.body.may_follow(no_impulse));
  CHECK(played.body.may_follow(1));
  refused(0, all, played.all(), Status::held_illegal_impulse);
  refused(3, all, played.all(), Status::held_out_of_range);
  refused(1, {played.need.least_work - 1}, played.states(), Status::held_over_budget);
  std::vector<float> wrong(5);
  std::vector<Vec3> many(101), two(2);
  refused(1, all, {wrong, {}, {}, {}}, Status::held_response_size);
  refused(1, all, {{}, wrong, {}, {}}, Status::held_response_size);
  refused(1, all, {{}, {}, many, {}}, Status::held_response_size);
  refused(1, all, {{}, {}, two, many}, Status::held_response_size);
  const std::vector<std::uint32_t> numbers = {1, 100};
  refused(1, all, {{}, {}, two, {}, numbers}, Status::held_out_of_range);
  refused(1, all, {{}, {}, played.displacement, {}, numbers}, Status::held_response_size);
  // it goes on as if nothing had been asked
  played.step();
  Played same(opened);
  same.step(0);
  for (int k = 0; k < 6; ++k) same.step();
  CHECK(played.coordinate == same.coordinate);
}

TEST_CASE("position and velocity do not jump where an orbit is entered, over a million random legal steps") {
  const Opened opened({.orbits = 30, .alternating = true});
  const ImpulseResponseView& view = opened.view();
  Played played(opened, {.rate = 1000});
  std::mt19937 random(5);
  std::vector<double> last(view.modes), last_velocity(view.modes);
  double worst_step = 0, worst_change = 0, most_blend = 0;
  std::uint32_t entered = 0, continued = 0, rested = 0;
  for (int k = 0; k < 1'000'000; ++k) {
    const std::uint32_t impulse = random_impulse(played, random, 3, 0.004);
    const auto report = played.body.step(impulse, {played.need.least_work}, played.states());
    REQUIRE(report.status == Status::ok);
    entered += impulse != no_impulse ? 1 : 0;
    continued += impulse == no_impulse && report.distance > 0 ? 1 : 0;
    rested += report.at_rest ? 1 : 0;
    most_blend = std::max(most_blend, static_cast<double>(report.blend));
    double step = 0, change = 0;
    for (std::uint32_t m = 0; m < view.modes; ++m) {
      const auto x = static_cast<double>(played.coordinate[m]), v = static_cast<double>(played.velocity[m]);
      step += std::pow(x - last[m], 2);
      change += std::pow(v - last_velocity[m], 2);
      last[m] = x;
      last_velocity[m] = v;
    }
    worst_step = std::max(worst_step, step);
    worst_change = std::max(worst_change, change);
  }
  CHECK(entered > 2000);
  CHECK(continued > 500);
  CHECK(rested > 10'000);
  // what stored states change by in a step of the loop, and what of a difference dies out in it
  double fastest = 0, change = 0;
  for (const layout::OrbitRecord& orbit : view.orbits) {
    for (std::uint32_t row = orbit.first_row + 1; row + 1 < orbit.first_row + orbit.rows; ++row) {
      double moved = 0, changed = 0;
      std::uint32_t mode = 0;
      for (std::uint32_t q = 0; q < view.levels; ++q) {
        const std::uint32_t modes = view.group[q].counts->modes;
        for (std::uint32_t m = 0; m < modes; ++m, ++mode) {
          const auto at = [&](std::uint32_t r) {
            return view.group[q].coordinates[std::size_t{r} * modes + m] / 32767.0 * amplitude(view, mode);
          };
          moved += std::pow(at(row + 1) - at(row), 2);
          changed += std::pow(at(row + 1) - 2 * at(row) + at(row - 1), 2);
        }
      }
      fastest = std::max(fastest, moved);
      change = std::max(change, changed);
    }
  }
  const double steps = 1e-3 / view.info->time_step,
               dies = 1 - std::exp(-static_cast<double>(view.info->blend_rate) * 1e-3);
  CHECK(std::sqrt(worst_step) <= 1.01 * (std::sqrt(fastest) * steps + most_blend * dies));
  CHECK(most_blend < 0.1);
  CHECK(std::sqrt(worst_change) < 2 * std::sqrt(change) / view.info->time_step * steps + 1);
}

TEST_CASE("the same history gives the same bits, and another body of the model does not matter") {
  const Opened opened({.modes = 8});
  Played a(opened), b(opened), other(opened);
  std::mt19937 random(7);
  for (int k = 0; k < 2000; ++k) {
    const std::uint32_t impulse = random_impulse(a, random, 3, 0.02);
    a.step(impulse);
    other.step(k % 100 == 0 ? 2 : no_impulse);
    b.step(impulse);
    REQUIRE(std::memcmp(a.displacement.data(), b.displacement.data(), a.displacement.size() * sizeof(Vec3)) == 0);
    REQUIRE(a.velocity == b.velocity);
  }
}

TEST_CASE("the scene begins at rest, and comes to rest when it is left alone") {
  const Opened opened({});
  Played played(opened);
  const auto begins = played.step();
  CHECK(begins.at_rest);
  CHECK(begins.orbit == 0);
  CHECK(begins.impulse == no_impulse);
  CHECK(*std::max_element(played.coordinate.begin(), played.coordinate.end()) == 0);
  played.step(2);
  ImpulseResponse::StepReport report;
  for (int k = 0; k < 20'000; ++k) report = played.step();
  CHECK(report.at_rest);
  CHECK(report.blend == 0);
  CHECK(*std::max_element(played.velocity.begin(), played.velocity.end()) == 0);
}

TEST_CASE("limits and models that cannot be played are refused by name") {
  const Opened opened({});
  const auto created = [&](const ImpulseResponse::Limits& limits) {
    AlignedBytes memory(1 << 16);
    CHECK(ImpulseResponse::required(opened.model, limits).bytes == 0);
    return ImpulseResponse::create(opened.model, limits, {memory.data(), memory.size()}).error;
  };
  CHECK(created({.rate = 1}) == CreateError::bad_limits);  // 128 states a step
  CHECK(created({.rate = -5}) == CreateError::bad_limits);
  CHECK(created({.stretch = 65}) == CreateError::bad_limits);
  CHECK(created({.stretch = std::nanf("")}) == CreateError::bad_limits);
  CHECK(created({.blend_rate = -1}) == CreateError::bad_limits);
  const auto need = ImpulseResponse::required(opened.model, {});
  AlignedBytes memory(need.bytes + 64);
  const auto small = ImpulseResponse::create(opened.model, {}, {memory.data(), need.bytes - 1});
  CHECK(small.error == CreateError::arena_too_small);
  CHECK(small.missing == 1);
  CHECK(ImpulseResponse::create(opened.model, {}, {memory.data() + 4, need.bytes}).error ==
        CreateError::arena_misaligned);
  const ModelFile elastic = encoded_file(synthetic_model({.levels = 1}));
  const auto model = Model::open(elastic.bytes.span());
  CHECK(ImpulseResponse::required(model.model, {}).bytes == 0);
  CHECK(ImpulseResponse::create(model.model, {}, {memory.data(), memory.size()}).error ==
        CreateError::unsupported_model);
}

TEST_CASE("C answers the same, bit for bit") {
  const Opened opened({.modes = 8, .planes = 2, .alternating = true});
  Played cpp(opened, {.rate = 500, .stretch = 0.5F});
  greenloop_model model;
  REQUIRE(greenloop_open(opened.file.bytes.data(), opened.file.bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  CHECK(greenloop_model_problem(&model) == GREENLOOP_PROBLEM_IMPULSE_RESPONSE);
  CHECK(greenloop_impulse_response_modes(&model) == 8);
  CHECK(greenloop_impulse_response_vertices(&model) == 100);
  CHECK(greenloop_impulse_response_impulses(&model) == 3);
  const greenloop_impulse_response_limits limits = {500, 0.5F, 0};
  const auto need = greenloop_impulse_response_required(&model, limits);
  CHECK(need.bytes == cpp.need.bytes);
  CHECK(need.least_work == cpp.need.least_work);
  CHECK(need.worst_work == cpp.need.worst_work);
  AlignedBytes memory(need.bytes);
  const auto created = greenloop_impulse_response_create(&model, limits, memory.data(), memory.size());
  REQUIRE(created.error == GREENLOOP_CREATE_OK);
  std::vector<float> coordinate(8), velocity(8), displacement(300), rate(300);
  const greenloop_impulse_response_buffers buffers = {
      coordinate.data(), velocity.data(), displacement.data(), rate.data(), nullptr, 8, 100};
  std::mt19937 random(9);
  for (int k = 0; k < 1000; ++k) {
    const auto impulse = k % 20 == 0 ? static_cast<std::uint32_t>(random() % 4) : no_impulse;
    CHECK((greenloop_impulse_response_may_follow(created.body, impulse) != 0) == cpp.body.may_follow(impulse));
    const auto expected = cpp.step(impulse);
    const auto found = greenloop_impulse_response_step(created.body, impulse, any_budget, buffers);
    REQUIRE(static_cast<int>(found.status) == static_cast<int>(expected.status));
    CHECK(found.work == expected.work);
    CHECK(found.orbit == expected.orbit);
    CHECK(found.row == expected.row);
    CHECK(found.blend == expected.blend);
    CHECK(found.truncation_error == expected.truncation_error);
    CHECK(std::memcmp(displacement.data(), cpp.displacement.data(), 1200) == 0);
    CHECK(std::memcmp(rate.data(), cpp.rate.data(), 1200) == 0);
    CHECK(coordinate == cpp.coordinate);
    CHECK(velocity == cpp.velocity);
  }
}

}  // namespace
}  // namespace greenloop
