// elastic_hour [SECONDS] [SEED]: a soft beam of 1,536 tetrahedra is loaded, led, turned under gravity and starved at
// random at 1 kHz, by rubbish too; every step is checked.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "offline/simulate/multigrid_model.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "rt_tests/harness/fast_digest.hpp"
#include "runtime/model.hpp"
#include "runtime/multigrid.hpp"

namespace {

using greenloop::Multigrid;
using greenloop::Vec3;

constexpr int cells = 4;
constexpr double length = 0.2, thickness = 0.05;  // m
constexpr float farthest_allowed = 0.4F;          // m, twice the beam's length

greenloop::offline::MultigridScene beam() {
  const auto box = [](int n) {
    return greenloop::offline::testing::box({4 * n, n, n}, {length, thickness, thickness});
  };
  greenloop::offline::MultigridScene scene;
  scene.mesh = box(cells);
  scene.coarser = {box(cells / 2)};
  for (const Eigen::Vector3d& v : scene.mesh.vertices) scene.fixed.push_back(v.x() < 1.0e-9 ? 1 : 0);
  scene.matter.kinds = {{{2.0e5, 0.4}, 1000.0}};
  scene.matter.kind.assign(scene.mesh.tetrahedra.size(), 0);
  scene.time_step = 1.0e-3;
  scene.numerical_damping = 0.1;
  scene.stiffness_damping = 5.0e-4;
  return scene;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint32_t below(std::uint32_t bound) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>((state_ >> 33) % bound);
  }
  float between(float low, float high) { return low + (high - low) * static_cast<float>(below(1U << 20)) * 0x1p-20F; }
  Vec3 vector(float size) { return {between(-size, size), between(-size, size), between(-size, size)}; }

 private:
  std::uint64_t state_;
};

/// What the world does to the beam, and goes on doing for a while.
class World {
 public:
  World(std::uint32_t free, std::uint64_t seed) : random_(seed), free_(free) {}

  void pass(const std::vector<Vec3>& displacement) {
    if (random_.below(200) == 0) {
      loads_.clear();
      for (std::uint32_t k = random_.below(4); k > 0; --k)
        loads_.push_back({random_.below(free_), random_.vector(0.5F)});
    }
    if (random_.below(2000) == 0) gravity_ = random_.vector(9.81F);
    if (cycles_left_ == 0 && random_.below(300) == 0) take_hold(displacement);
    if (cycles_left_ > 0) lead();
  }
  [[nodiscard]] Multigrid::Inputs inputs() const { return {loads_, holds_, &gravity_}; }
  [[nodiscard]] Random& random() { return random_; }

 private:
  void take_hold(const std::vector<Vec3>& displacement) {
    const std::uint32_t v = random_.below(free_);
    holds_ = {{v, displacement[v]}};
    velocity_ = random_.vector(1.0e-4F);  // m a cycle
    cycles_left_ = 50 + random_.below(250);
  }
  void lead() {
    Vec3& at = holds_[0].displacement;
    at = {at.x + velocity_.x, at.y + velocity_.y, at.z + velocity_.z};
    if (--cycles_left_ == 0) holds_.clear();
  }

  Random random_;
  std::uint32_t free_;
  std::vector<Multigrid::Load> loads_;
  std::vector<Multigrid::Hold> holds_;
  Vec3 gravity_{0, 0, -9.81F}, velocity_;
  std::uint32_t cycles_left_ = 0;
};

struct Counts {
  std::uint64_t ok = 0, coarser = 0, refused = 0, overflows = 0, over_budget = 0, answered_rubbish = 0;
  double residual = 0, worst_residual = 0;
  float farthest = 0;

  [[nodiscard]] bool held() const {
    return overflows == 0 && over_budget == 0 && answered_rubbish == 0 && farthest <= farthest_allowed;
  }
};

void check_rubbish(Multigrid& body, Random& random, const Multigrid::Response& response, Counts& counts) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Multigrid::Load nowhere{0xffffff, {1, 0, 0}}, nothing{3, {nan, 0, 0}};
  const Multigrid::Hold twice[] = {{5, {}}, {5, {}}};
  const Multigrid::Inputs rubbish[] = {{.loads = {&nowhere, 1}}, {.loads = {&nothing, 1}}, {.holds = twice}};
  const auto report = body.step(rubbish[random.below(3)], {std::uint64_t{1} << 60}, response);
  (greenloop::answered(report.status) ? counts.answered_rubbish : counts.refused)++;
}

void count(const Multigrid::StepReport& report, std::uint64_t work, Counts& counts) {
  counts.over_budget += report.work > work ? 1 : 0;
  counts.overflows += report.status == greenloop::Status::held_overflow ? 1 : 0;
  if (!greenloop::answered(report.status)) {
    ++counts.refused;
    return;
  }
  (report.status == greenloop::Status::ok ? counts.ok : counts.coarser)++;
  counts.residual += static_cast<double>(report.residual);
  counts.worst_residual = std::fmax(counts.worst_residual, static_cast<double>(report.residual));
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 20;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (!(seconds > 0)) {
    std::fputs("elastic_hour [SECONDS] [SEED]\n", stderr);
    return 2;
  }
  const greenloop::ModelFile file = greenloop::encoded_file(greenloop::offline::multigrid_model(beam()));
  const greenloop::Model model = greenloop::Model::open(file.bytes.span()).model;
  const Multigrid::Requirement need = Multigrid::required(model, {});
  greenloop::AlignedBytes memory(need.bytes);
  Multigrid body = Multigrid::create(model, {}, {memory.data(), memory.size()}).body;
  const greenloop::MultigridView& view = file.view.multigrid;
  std::vector<Vec3> displacement(view.info->vertices);
  const Multigrid::Response response{.displacement = displacement};
  World world(view.info->free, seed);
  Counts counts;
  greenloop::FastDigest digest;
  const auto steps = static_cast<std::uint64_t>(seconds / view.info->time_step);
  for (std::uint64_t i = 0; i < steps; ++i) {
    world.pass(displacement);
    if (world.random().below(50) == 0) check_rubbish(body, world.random(), response, counts);
    // starved, a cycle more, plenty, or too little
    const std::uint32_t kind = world.random().below(40);
    const std::uint64_t work = kind == 0   ? need.least_work / 2
                               : kind < 20 ? need.least_work
                               : kind < 30 ? need.least_work + need.cycle_work
                                           : 4 * need.least_work;
    count(body.step(world.inputs(), {work}, response), work, counts);
    for (const Vec3& d : displacement) counts.farthest = std::fmax(counts.farthest, std::hypot(d.x, d.y, d.z));
    digest.add(std::as_bytes(std::span(displacement)));
  }
  const std::uint64_t answers = counts.ok + counts.coarser;
  std::printf(
      "%llu cycles of %u tetrahedra at 1 kHz, arena %zu bytes, least work %llu, a cycle %llu units: %llu within the "
      "tolerance, %llu "
      "short of budget, %llu refused; residual %.1e on average, %.1e at worst; farthest %.3f m, %llu not finite or "
      "too far, %llu beyond the budget, %llu answers to rubbish; digest %016llx\n%s\n",
      static_cast<unsigned long long>(steps), view.info->tetrahedra, need.bytes,
      static_cast<unsigned long long>(need.least_work), static_cast<unsigned long long>(need.cycle_work),
      static_cast<unsigned long long>(counts.ok), static_cast<unsigned long long>(counts.coarser),
      static_cast<unsigned long long>(counts.refused), counts.residual / static_cast<double>(answers),
      counts.worst_residual, static_cast<double>(counts.farthest), static_cast<unsigned long long>(counts.overflows),
      static_cast<unsigned long long>(counts.over_budget), static_cast<unsigned long long>(counts.answered_rubbish),
      static_cast<unsigned long long>(digest.value()), counts.held() ? "HELD" : "VIOLATED");
  return counts.held() ? 0 : 1;
}
