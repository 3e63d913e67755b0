// Runs steps with every guard armed: no allocation, lock, system call or page fault in the loop. Each guard is first
// shown to trip.
#include <doctest/doctest.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <vector>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "rt_tests/harness/impulse_run.hpp"
#include "rt_tests/harness/minor_faults.hpp"
#include "rt_tests/harness/touching_script.hpp"
#include "runtime/bound_mesh.hpp"
#include "runtime/look.hpp"
#include "runtime/mask.hpp"
#include "runtime/multigrid.hpp"
#include "runtime/relief.hpp"
#include "runtime/surface.hpp"
#include "runtime/testing/search_bench.hpp"
#include "runtime/testing/split_surface.hpp"
#include "runtime/testing/test_body.hpp"
#include "sim_hw/guard/guarded.hpp"

namespace greenloop {
namespace {

constexpr int cycles = 2000;

// contact sets of every kind a loop meets, refused ones among them, made before the loop
class Scripted {
 public:
  explicit Scripted(layout::Wavelet wavelet = layout::Wavelet::lifted_linear)
      : model_({.levels = 4, .wavelet = wavelet}), body_(model_, {.max_contacts = 16, .cached_factors = 4}) {
    std::mt19937_64 random(12);
    const auto nodes = model_.touchable();
    for (int k = 0; k < 40; ++k) {
      std::vector<Constraint> contacts;
      const std::size_t first = random() % nodes.size();
      for (std::size_t i = 0; i < random() % 17; ++i) {
        contacts.push_back({nodes[(first + 7 * i) % nodes.size()], {1e-3F, 0, static_cast<float>(k) * 1e-5F}});
      }
      if (k % 10 == 9) {
        contacts.push_back({0xffffffff, {}});
      }
      sets_.push_back(contacts);
    }
  }

  Elastostatic::StepReport cycle(int i) {
    const std::size_t k = static_cast<std::size_t>(i) * 7 % sets_.size();
    const auto& need = body_.requirement();
    const std::uint64_t budget = i % 3 == 0 ? need.least_work : need.worst_work[3];
    return body_.step(sets_[k], budget, i % 5 != 0);
  }

 private:
  TestModel model_;
  TestBody body_;
  std::vector<std::vector<Constraint>> sets_;
};

// tools of all shapes that press, drag, jump and are refused
class Touching {
 public:
  Touching()
      : model_({.levels = 4}),
        limits_(TouchingScript::limits(64, 30)),
        need_(ContactBody::required(model_.model(), limits_)),
        memory_(need_.bytes),
        body_(ContactBody::create(model_.model(), limits_, {memory_.data(), memory_.size()}).body),
        script_(model_.model(), need_, 3) {}

  ContactBody::StepReport cycle() {
    const TouchingScript::Cycle cycle = script_.next(body_);
    return body_.step(cycle.tools, {}, cycle.budget);
  }

 private:
  TestModel model_;
  ContactBody::Limits limits_;
  ContactBody::Requirement need_;
  AlignedBytes memory_;
  ContactBody body_;
  TouchingScript script_;
};

// impulses on motions, refused ones among them
class Moving {
 public:
  Moving()
      : file_(encoded_file(synthetic_motion({.planes = 2, .alternating = true, .transfer_modes = 4}))),
        model_(Model::open(file_.bytes.span()).model),
        need_(ImpulseResponse::required(model_, {})),
        memory_(need_.bytes),
        body_(ImpulseResponse::create(model_, {}, {memory_.data(), memory_.size()}).body),
        script_(model_, need_, 3),
        coordinate_(6),
        displacement_(101),
        colour_(101) {}

  ImpulseResponse::StepReport cycle() {
    const ImpulseScript::Cycle cycle = script_.next();
    return body_.step(cycle.impulse, cycle.budget,
                      {coordinate_,
                       {},
                       std::span(displacement_).first(cycle.vertices),
                       {},
                       {},
                       std::span(colour_).first(cycle.lit ? cycle.vertices : 0),
                       &cycle.light});
  }

 private:
  ModelFile file_;
  Model model_;
  ImpulseResponse::Requirement need_;
  AlignedBytes memory_;
  ImpulseResponse body_;
  ImpulseScript script_;
  std::vector<float> coordinate_;
  std::vector<Vec3> displacement_, colour_;
};

// loads, holds and budgets of a multigrid body, refused ones among them
class Elastic {
 public:
  explicit Elastic(layout::Strain strain)
      : file_(encoded_file(synthetic_multigrid({.cells = 4, .strain = strain}))),
        model_(Model::open(file_.bytes.span()).model),
        need_(Multigrid::required(model_, {})),
        memory_(need_.bytes),
        body_(Multigrid::create(model_, {}, {memory_.data(), memory_.size()}).body),
        displacement_(file_.view.multigrid.info->vertices),
        stress_(displacement_.size()) {}

  Multigrid::StepReport cycle() {
    ++cycles_;
    const float swing = static_cast<float>(cycles_ % 40) - 20;
    const Multigrid::Load load{cycles_ % 18, {0.001F * swing, 0.01F, 0}};
    const Multigrid::Hold hold{cycles_ / 50 % 17, {0, 1.0e-5F * swing, 0}};
    const std::uint64_t work =
        need_.least_work + (cycles_ % 3) * need_.cycle_work + need_.shown_work + need_.stress_work;
    return body_.step({.loads = {&load, 1}, .holds = {&hold, cycles_ % 100 < 50 ? 1U : 0U}},
                      {cycles_ % 7 == 0 ? work / 16 : work},
                      {.displacement = displacement_, .shown = shown_, .stress = stress_});
  }

 private:
  ModelFile file_;
  Model model_;
  Multigrid::Requirement need_;
  AlignedBytes memory_;
  Multigrid body_;
  std::vector<Vec3> displacement_;
  Vec3 shown_[3];
  std::vector<float> stress_;
  std::uint32_t cycles_ = 0;
};

TEST_CASE("no allocation and no lock in the steps of a multigrid body, of any strain") {
  for (const auto strain : {layout::Strain::linear, layout::Strain::corotational, layout::Strain::green}) {
    Elastic elastic(strain);
    const std::uint64_t allocations = allocation_guard::count();
    const std::uint64_t locks = mutex_guard::count();
    allocation_guard::arm();
    mutex_guard::arm();
    int steps = 0, refused = 0;
    for (int i = 0; i < cycles; ++i) {
      const auto report = elastic.cycle();
      (answered(report.status) ? steps : refused)++;
    }
    mutex_guard::disarm();
    allocation_guard::disarm();
    CHECK(steps > cycles / 2);
    CHECK(refused > 0);
    CHECK(allocation_guard::count() == allocations);
    CHECK(mutex_guard::count() == locks);
  }
}

TEST_CASE("the allocation guard trips on malloc, new and free") {
  void* volatile memory = nullptr;
  const auto trips = [](auto act) {
    const std::uint64_t before = allocation_guard::count();
    allocation_guard::arm();
    act();
    allocation_guard::disarm();
    return allocation_guard::count() - before;
  };
  CHECK(trips([&] { memory = std::malloc(10); }) == 1);
  CHECK(trips([&] { std::free(memory); }) == 1);
  CHECK(trips([&] { memory = new int(1); }) == 1);
  CHECK(trips([&] { delete static_cast<int*>(memory); }) == 1);
  CHECK(trips([&] { memory = std::aligned_alloc(64, 128); }) == 1);
  CHECK(trips([] {}) == 0);
  std::free(memory);
}

TEST_CASE("the mutex guard trips on a lock") {
  std::mutex mutex;
  const std::uint64_t before = mutex_guard::count();
  mutex_guard::arm();
  { const std::lock_guard lock(mutex); }
  mutex_guard::disarm();
  CHECK(mutex_guard::count() == before + 1);
  { const std::lock_guard lock(mutex); }
  CHECK(mutex_guard::count() == before + 1);
}

TEST_CASE("the mutex guard trips on every other kind of lock") {
  const auto trips = [](auto act) {
    const std::uint64_t before = mutex_guard::count();
    mutex_guard::arm();
    act();
    mutex_guard::disarm();
    return mutex_guard::count() - before;
  };
  std::mutex mutex;
  CHECK(trips([&] { CHECK(mutex.try_lock()); }) == 1);
  mutex.unlock();
  std::shared_mutex shared;
  CHECK(trips([&] { shared.lock(); }) == 1);
  shared.unlock();
  CHECK(trips([&] { shared.lock_shared(); }) == 1);
  shared.unlock_shared();
  pthread_spinlock_t spin{};
  REQUIRE(pthread_spin_init(&spin, PTHREAD_PROCESS_PRIVATE) == 0);
  CHECK(trips([&] { pthread_spin_lock(&spin); }) == 1);
  pthread_spin_unlock(&spin);
  sem_t semaphore{};
  REQUIRE(sem_init(&semaphore, 0, 1) == 0);
  CHECK(trips([&] { sem_wait(&semaphore); }) == 1);
  CHECK(trips([] {}) == 0);
}

TEST_CASE("no allocation and no lock in the loop") {
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  Scripted scripted(kind);
  GuardCounts seen;
  int refused = 0;
  for (int i = 0; i < cycles; ++i) {
    seen += guarded([&] { refused += !answered(scripted.cycle(i).status) ? 1 : 0; });
  }
  CHECK(seen.allocations == 0);
  CHECK(seen.locks == 0);
  CHECK(refused > 0);
  CHECK(refused < cycles / 2);
}

TEST_CASE("no allocation, lock or minor page fault in steps of tools, whatever their poses") {
  Touching touching;
  for (int i = 0; i < 100; ++i) touching.cycle();
  GuardCounts seen;
  int refused = 0, pushed = 0;
  const std::uint64_t faults = minor_faults();
  for (int i = 0; i < cycles; ++i) {
    ContactBody::StepReport report;
    seen += guarded([&] { report = touching.cycle(); });
    refused += answered(report.status) ? 0 : 1;
    pushed += report.iterations > 0 ? 1 : 0;
  }
  CHECK(minor_faults() == faults);
  CHECK(seen.allocations == 0);
  CHECK(seen.locks == 0);
  CHECK(refused > 0);
  CHECK(pushed > cycles / 2);
}

TEST_CASE("no allocation, lock or minor page fault in steps of impulses") {
  Moving moving;
  for (int i = 0; i < 100; ++i) moving.cycle();
  GuardCounts seen;
  int refused = 0;
  const std::uint64_t faults = minor_faults();
  for (int i = 0; i < cycles; ++i) {
    ImpulseResponse::StepReport report;
    seen += guarded([&] { report = moving.cycle(); });
    refused += answered(report.status) ? 0 : 1;
  }
  CHECK(minor_faults() == faults);
  CHECK(seen.allocations == 0);
  CHECK(seen.locks == 0);
  CHECK(refused > 0);
  CHECK(refused < cycles / 2);
}

TEST_CASE("no allocation and no lock in what a surface is asked, nor when it is made") {
  const TestModel model({.levels = 4});
  AlignedBytes memory(Surface::required(model.model(), 3).bytes);
  std::vector<Vec4> normal(model.model().node_count());
  std::vector<float> area(normal.size());
  std::vector<std::uint32_t> node(normal.size());
  const std::uint32_t touchable = model.touchable()[0];
  const std::uint64_t allocations = allocation_guard::count();
  const std::uint64_t locks = mutex_guard::count();
  allocation_guard::arm();
  mutex_guard::arm();
  const auto created = Surface::create(model.model(), 3, {memory.data(), memory.size()});
  bool right = bool{created} && created.surface.normals(3, {}, normal) && created.surface.areas(3, normal, area);
  for (int i = 0; i < cycles; ++i) {
    const Vec3 position{static_cast<float>(i) * 1e-4F - 0.1F, 0.01F, 0.02F};
    right = right && created.surface.nearest_node(position).node != layout::none &&
            created.surface.nearest_point(position).triangle != layout::none &&
            !make_mask(created.surface, 3, at_node(touchable), 0.02F, node, area).node.empty();
  }
  mutex_guard::disarm();
  allocation_guard::disarm();
  CHECK(right);
  CHECK(allocation_guard::count() == allocations);
  CHECK(mutex_guard::count() == locks);
}

TEST_CASE("no allocation and no lock in finer pictures and relief, nor when they are made") {
  const TestModel model({.levels = 4});
  const SplitSurface split(model, 3, {2, FinerSurface::Rule::loop});
  const FinerSurface::Options options{2, FinerSurface::Rule::midpoint};
  AlignedBytes finer_memory(FinerSurface::required(split.surface, options));
  const std::vector<Vec3> vertex(100, Vec3{0.01F, 0.02F, 0.11F});
  AlignedBytes bound_memory(BoundMesh::required(split.surface, vertex.size()));
  std::vector<Vec4> position(split.finer.vertex_count(2)), normal(position.size()), bound_position(vertex.size());
  const std::vector<Vec3> detail(position.size(), Vec3{0, 0.3F, 1});
  std::vector<Vec3> slope(position.size());
  std::vector<std::uint8_t> seen(split.surface.triangle_count(1));
  ContactBody::Contact contact;
  contact.node[1] = 1;
  contact.node[2] = 2;
  contact.weight[0] = contact.weight[1] = 0.5;
  contact.normal = contact.force = {0, 0, 1};
  const std::uint64_t allocations = allocation_guard::count();
  const std::uint64_t locks = mutex_guard::count();
  allocation_guard::arm();
  mutex_guard::arm();
  const auto finer = FinerSurface::create(split.surface, options, {finer_memory.data(), finer_memory.size()});
  const auto bound = BoundMesh::create(split.surface, vertex, {bound_memory.data(), bound_memory.size()});
  bool right = bool{finer} && bool{bound};
  for (int i = 0; i < 100; ++i) {
    const Look look{{0.01F * static_cast<float>(i), 0, 1}, {0, 0, -1}, 0.5F, 1e-3F};
    right = right && look_at(split.surface, {}, look, seen).triangles > 0 && split.finer.positions(2, {}, position) &&
            finer.surface.positions(2, {}, position) && split.finer.normals(2, position, normal) &&
            bound.mesh.positions({}, normal, seen, bound_position) && relief_slopes(normal, detail, slope) &&
            relief_friction(split.finer, slope, 0.3, {1e-3, 0, 0}, {&contact, 1}) >= 0;
  }
  mutex_guard::disarm();
  allocation_guard::disarm();
  CHECK(right);
  CHECK(allocation_guard::count() == allocations);
  CHECK(mutex_guard::count() == locks);
}

TEST_CASE("no allocation and no lock in a search for candidates, nor when it is made") {
  DeformedBody body({.levels = 4, .touchable_above = -0.4}, 0.1F);
  const CandidateSearch::Limits limits{.max_tools = 2, .max_candidates = 16, .margin = 0.01};
  AlignedBytes memory(CandidateSearch::required(limits));
  const std::uint64_t allocations = allocation_guard::count();
  const std::uint64_t locks = mutex_guard::count();
  allocation_guard::arm();
  mutex_guard::arm();
  auto created = CandidateSearch::create(limits, {memory.data(), memory.size()});
  std::uint64_t work = 0;
  std::size_t candidates = 0;
  for (int i = 0; created && i < cycles; ++i) {
    const double x = 0.1 - 1e-4 * i;
    const Tool tools[] = {{Shape::box({0.01, 0.02, 0.03}), {{x, 0, 0}, {1, 0, 0, 0}}},
                          {Shape::capsule(0.01, 0.02), {{-x, 0.01, 0.02}, {1, 0, 0, 0}}}};
    body.surface.update(body.displacement, work);
    candidates += created.search.find(body.surface, tools, work).candidates.size();
  }
  mutex_guard::disarm();
  allocation_guard::disarm();
  CHECK(candidates > 1000);
  CHECK(allocation_guard::count() == allocations);
  CHECK(mutex_guard::count() == locks);
}

TEST_CASE("no minor page fault in the loop once it is warm; a fresh page is seen") {
  Scripted scripted;
  for (int i = 0; i < 100; ++i) {
    scripted.cycle(i);
  }
  const std::uint64_t before = minor_faults();
  for (int i = 0; i < cycles; ++i) {
    scripted.cycle(i);
  }
  CHECK(minor_faults() == before);
  constexpr std::size_t bytes = 64 << 20;
  auto* fresh = static_cast<volatile char*>(std::malloc(bytes));
  for (std::size_t i = 0; i < bytes; i += 4096) {
    fresh[i] = 1;
  }
  CHECK(minor_faults() > before);
  std::free(const_cast<char*>(fresh));
}

TEST_CASE("no system call in the loop, by Syscall User Dispatch") {
  if (!system_call_guard::install()) {
    MESSAGE("this kernel has no Syscall User Dispatch: system calls are watched by the seccomp test alone");
    return;
  }
  Scripted scripted;
  system_call_guard::arm();
  const long pid = syscall(SYS_getppid);
  system_call_guard::disarm();
  CHECK(system_call_guard::count() == 1);
  CHECK(system_call_guard::last() == SYS_getppid);
  CHECK(pid == getppid());
  for (int i = 0; i < cycles; ++i) {
    system_call_guard::arm();
    scripted.cycle(i);
    system_call_guard::disarm();
  }
  Touching touching;
  for (int i = 0; i < cycles; ++i) {
    system_call_guard::arm();
    touching.cycle();
    system_call_guard::disarm();
  }
  Moving moving;
  for (int i = 0; i < cycles; ++i) {
    system_call_guard::arm();
    moving.cycle();
    system_call_guard::disarm();
  }
  CHECK(system_call_guard::count() == 1);
}

// status of a child in which every system call but read, write and exit is deadly
template <class Work>
int strict_child(Work work) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) {
      syscall(SYS_exit, 99);
    }
    work();
    syscall(SYS_exit, 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST_CASE("no system call in the loop, by strict seccomp") {
  Scripted scripted;
  Touching touching;
  Moving moving;
  const int caught = strict_child([] { static_cast<void>(syscall(SYS_getppid)); });
  REQUIRE(!(WIFEXITED(caught) && WEXITSTATUS(caught) == 99));
  CHECK(WIFSIGNALED(caught));
  const int clean = strict_child([&] {
    for (int i = 0; i < cycles; ++i) {
      scripted.cycle(i);
      touching.cycle();
      moving.cycle();
    }
  });
  CHECK(WIFEXITED(clean));
  CHECK(WEXITSTATUS(clean) == 0);
}

}  // namespace
}  // namespace greenloop
