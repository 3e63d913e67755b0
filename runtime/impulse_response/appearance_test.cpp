// Colours against the same sums in double precision from the file's numbers, and what a loop may rely on.

#include "runtime/impulse_response/appearance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "runtime/greenloop_impulse.h"
#include "runtime/impulse_response.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t no_impulse = ImpulseResponse::no_impulse;
constexpr std::uint32_t vertices = 100, transfer_modes = 5;

Light random_light(std::mt19937& random) {
  std::normal_distribution<float> normal;
  Light light;
  for (float* const colour : {light.red, light.green, light.blue}) {
    for (std::uint32_t i = 0; i < Light::coefficients; ++i) colour[i] = normal(random);
  }
  return light;
}

/// A body of a model with an appearance and buffers for it.
struct Shown {
  explicit Shown(const SyntheticMotion& options = {.transfer_modes = transfer_modes})
      : file(encoded_file(synthetic_motion(options))),
        model(Model::open(file.bytes.span()).model),
        need(ImpulseResponse::required(model, {})),
        memory(need.bytes),
        body(ImpulseResponse::create(model, {}, {memory.data(), memory.size()}).body),
        coordinate(model.view().impulse_response.modes),
        colour(vertices) {}

  ImpulseResponse::StepReport step(const Light& light, std::uint32_t impulse = no_impulse) {
    return body.step(impulse, {need.worst_work}, {.coordinate = coordinate, .colour = colour, .light = &light});
  }
  [[nodiscard]] const ImpulseResponseView& view() const { return model.view().impulse_response; }

  // of the synthetic model, whose transfers follow its displacements
  [[nodiscard]] double transfer_coordinate(std::uint32_t mode) const {
    std::uint32_t q = 0, m = mode;
    while (m >= view().group[q].counts->modes) m -= view().group[q++].counts->modes;
    return static_cast<double>(coordinate[mode]) / static_cast<double>(view().group[q].amplitudes[m].amplitude);
  }

  [[nodiscard]] double radiance(const float* light, std::uint32_t vertex, std::uint32_t colour_index) const {
    const AppearanceView& of = view().appearance;
    const std::uint32_t block = vertex / 16;
    const std::int8_t* const at = of.transfers + (3 * block + colour_index) * layout::transfer_bytes(of.modes);
    double sum = 0;
    for (std::uint32_t i = 0; i < 16 * (2 + of.modes); ++i) {
      const double value = at[32 * (i / 2) + 2 * (vertex % 16) + i % 2];
      const std::uint32_t part = i / 16;
      const double weight = part == 0 ? 256 : part == 1 ? 1 : transfer_coordinate(part - 2);
      sum += static_cast<double>(of.quanta[2 * block + (part < 2 ? 0 : 1)]) * value * weight *
             static_cast<double>(light[i % 16]);
    }
    return sum;
  }

  ModelFile file;
  Model model;
  ImpulseResponse::Requirement need;
  AlignedBytes memory;
  ImpulseResponse body;
  std::vector<float> coordinate;
  std::vector<Vec3> colour;
};

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST_CASE("colours are sums of transfers and light, through orbits, interrupts and blends") {
  Shown shown;
  std::mt19937 random(11);
  double worst = 0, largest = 0;
  for (int i = 0; i < 400; ++i) {
    const Light light = random_light(random);
    const auto report = shown.step(light, i % 17 == 0 ? static_cast<std::uint32_t>(random() % 3) : no_impulse);
    REQUIRE(report.status == Status::ok);
    CHECK(report.transfer_modes == transfer_modes);
    CHECK(report.transfer_error == doctest::Approx(0.1));
    CHECK(report.modes == 0);
    for (const std::uint32_t v : {0U, 15U, 16U, 99U}) {
      const float found[3] = {shown.colour[v].x, shown.colour[v].y, shown.colour[v].z};
      const float* const of[3] = {light.red, light.green, light.blue};
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double exact = shown.radiance(of[c], v, c);
        worst = std::max(worst, std::abs(exact - static_cast<double>(found[c])));
        largest = std::max(largest, std::abs(exact));
      }
    }
  }
  CHECK(largest > 0.3);
  CHECK(worst < 2e-4 * largest);
}

TEST_CASE("any vertices, chosen ones, and all have the same bits, with AVX2 and without") {
  std::mt19937 random(5);
  const Light light = random_light(random);
  Shown all, some, first;
  const std::vector<std::uint32_t> chosen = {99, 0, 16, 15};
  std::vector<Vec3> of_chosen(chosen.size()), of_first(37);
  for (int i = 0; i < 50; ++i) {
    const std::uint32_t impulse = i == 3 ? 1 : no_impulse;
    REQUIRE(answered(all.step(light, impulse).status));
    REQUIRE(answered(
        some.body.step(impulse, {some.need.worst_work}, {.chosen = chosen, .colour = of_chosen, .light = &light})
            .status));
    REQUIRE(answered(first.body.step(impulse, {first.need.worst_work}, {.colour = of_first, .light = &light}).status));
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      CHECK(std::memcmp(&of_chosen[k], &all.colour[chosen[k]], sizeof(Vec3)) == 0);
    }
    CHECK(std::memcmp(of_first.data(), all.colour.data(), of_first.size() * sizeof(Vec3)) == 0);
  }
  std::vector<std::int16_t> numbers(lit_numbers(transfer_modes));
  const float coordinates[transfer_modes] = {0.5F, -0.25F, 1, 0, 0.125F};
  const LitState lit = lit_state(light, coordinates, transfer_modes, numbers.data());
  std::vector<Vec3> plain(vertices), fast(vertices);
  sum_colours(all.view(), lit, vertices, false, plain.data());
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    sum_colours(all.view(), lit, vertices, true, fast.data());
    CHECK(same_bits(plain, fast));
  }
#endif
}

TEST_CASE("colours are linear in the light") {
  std::mt19937 random(8);
  const Light first = random_light(random), second = random_light(random);
  Light both, twice;
  for (std::uint32_t i = 0; i < 16; ++i) {
    both.red[i] = first.red[i] + second.red[i];
    both.green[i] = first.green[i] + second.green[i];
    both.blue[i] = first.blue[i] + second.blue[i];
    twice.red[i] = 2 * first.red[i];
    twice.green[i] = 2 * first.green[i];
    twice.blue[i] = 2 * first.blue[i];
  }
  const auto lit = [](const Light& light) {
    Shown shown;
    for (int i = 0; i < 9; ++i) REQUIRE(answered(shown.step(light, i == 0 ? 2 : no_impulse).status));
    return shown.colour;
  };
  const auto of_first = lit(first), of_second = lit(second), of_both = lit(both), of_twice = lit(twice);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    CHECK(of_both[v].x == doctest::Approx(of_first[v].x + of_second[v].x).epsilon(1e-3).scale(1));
    CHECK(of_twice[v].y == 2 * of_first[v].y);
  }
  for (const Vec3& dark : lit({})) CHECK(dark.x + dark.y + dark.z == 0);
  Light faint;
  faint.red[0] = 1e-38F;
  for (const Vec3& dark : lit(faint)) CHECK(dark.x == 0);
}

TEST_CASE("a smaller budget leaves out modes of colours first, then of displacements, never the mean") {
  std::mt19937 random(2);
  const Light light = random_light(random);
  Shown shown({.planes = 2, .transfer_modes = transfer_modes});
  std::vector<Vec3> moved(vertices);
  const ImpulseResponse::Response response = {.displacement = moved, .colour = shown.colour, .light = &light};
  std::uint32_t before = 100, most = 0, least = 100;
  for (std::uint64_t work = shown.need.worst_work; work > shown.need.least_work; work -= 7) {
    const auto report = shown.body.step(no_impulse, {work}, response);
    CHECK(report.work <= work);
    if (!answered(report.status)) {
      CHECK(report.status == Status::held_over_budget);
      break;
    }
    const std::uint32_t rank = 100 * report.modes + report.transfer_modes;
    CHECK((report.status == Status::ok) == (report.modes == 6 && report.planes == 2 && report.transfer_modes == 5));
    CHECK(report.transfer_error == doctest::Approx(report.transfer_modes == 0 ? 1 : 0.5 / report.transfer_modes));
    before = rank;
    most = std::max(most, report.transfer_modes);
    least = std::min(least, report.transfer_modes);
  }
  CHECK(before / 100 == 2);
  CHECK(most == transfer_modes);
  CHECK(least == 0);
  CHECK(shown.need.worst_work > shown.need.frame_work + shown.need.colour_work);
}

TEST_CASE("what is no light, or of a model without appearance, is refused and changes nothing") {
  std::mt19937 random(2);
  Light light = random_light(random);
  Shown shown, plain(SyntheticMotion{});
  CHECK(plain.need.colour_work == 0);
  CHECK(plain.step(light).status == Status::held_response_size);
  CHECK(shown.step(light).status == Status::ok);
  const auto before = shown.colour;
  const auto refused = [&](const ImpulseResponse::Response& response, Status status) {
    const auto report = shown.body.step(0, {shown.need.worst_work}, response);
    CHECK(report.status == status);
    CHECK(same_bits(before, shown.colour));
  };
  refused({.colour = shown.colour}, Status::held_response_size);
  std::vector<Vec3> moved(vertices - 1);
  refused({.displacement = moved, .colour = shown.colour, .light = &light}, Status::held_response_size);
  const std::vector<std::uint32_t> chosen(vertices, vertices);
  refused({.chosen = chosen, .colour = shown.colour, .light = &light}, Status::held_out_of_range);
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1e30F}) {
    light.blue[15] = wrong;
    refused({.colour = shown.colour, .light = &light}, Status::held_not_finite);
  }
}

TEST_CASE("colours do not jump where an orbit is left for another") {
  Light even;
  for (float* const colour : {even.red, even.green, even.blue}) colour[0] = 3.5F;
  Shown shown({.alternating = true, .transfer_modes = transfer_modes});
  std::mt19937 random(4);
  float most_at_switch = 0, most_elsewhere = 0;
  auto last = shown.colour;
  for (int i = 0; i < 6000; ++i) {
    const std::uint32_t wanted = random() % 40 == 0 ? static_cast<std::uint32_t>(random() % 3) : no_impulse;
    const std::uint32_t impulse = shown.body.may_follow(wanted) ? wanted : no_impulse;
    const auto report = shown.step(even, impulse);
    REQUIRE(answered(report.status));
    float change = 0;
    for (std::uint32_t v = 0; v < vertices; ++v) change = std::max(change, std::abs(shown.colour[v].x - last[v].x));
    if (i > 0)
      (report.distance > 0 ? most_at_switch : most_elsewhere) =
          std::max(report.distance > 0 ? most_at_switch : most_elsewhere, change);
    last = shown.colour;
  }
  CHECK(most_elsewhere > 0);
  CHECK(most_at_switch > 0);
  CHECK(most_at_switch < 1.5F * most_elsewhere);
}

TEST_CASE("C gives the same bits, and turns light") {
  std::mt19937 random(9);
  const Light light = random_light(random);
  greenloop_light c_light;
  static_assert(sizeof c_light == sizeof light);
  std::memcpy(&c_light, &light, sizeof light);
  Shown shown;
  greenloop_model model;
  REQUIRE(greenloop_open(shown.file.bytes.data(), shown.file.bytes.size(), &model).rule == GREENLOOP_RULE_OK);
  const auto need = greenloop_impulse_response_required(&model, {});
  CHECK(need.colour_work == shown.need.colour_work);
  CHECK(need.worst_work == shown.need.worst_work);
  AlignedBytes memory(need.bytes);
  const auto created = greenloop_impulse_response_create(&model, {}, memory.data(), memory.size());
  REQUIRE(created.error == GREENLOOP_CREATE_OK);
  std::vector<Vec3> colour(vertices);
  greenloop_impulse_response_buffers buffers = {};
  buffers.vertices = vertices;
  buffers.colour = &colour[0].x;
  buffers.light = &c_light;
  for (int i = 0; i < 30; ++i) {
    const std::uint32_t impulse = i % 10 == 0 ? static_cast<std::uint32_t>(i / 10) : no_impulse;
    const auto expected = shown.step(light, impulse);
    const auto found = greenloop_impulse_response_step(created.body, impulse, need.worst_work, buffers);
    REQUIRE(found.status == GREENLOOP_OK);
    CHECK(found.work == expected.work);
    CHECK(found.transfer_modes == expected.transfer_modes);
    CHECK(found.transfer_error == expected.transfer_error);
    CHECK(same_bits(colour, shown.colour));
  }
  const float turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  const greenloop_light turned = greenloop_light_rotated(&c_light, turn);
  const Light expected = rotated(light, turn);
  CHECK(std::memcmp(&turned, &expected, sizeof turned) == 0);
  float harmonics[16], of_c[16];
  const float along[3] = {0, 0.6F, 0.8F};
  light_harmonics({0, 0.6F, 0.8F}, harmonics);
  greenloop_light_harmonics(along, of_c);
  CHECK(std::memcmp(harmonics, of_c, sizeof of_c) == 0);
}

}  // namespace
}  // namespace greenloop
