// How deep the stack of a step goes, on every way the planner can take: below what docs/loop.md promises. Linked so
// that library functions are looked up at the start: the linker's own stack is not the step's.
#include <doctest/doctest.h>
#include <ucontext.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "formats/testing/synthetic_motion.hpp"
#include "rt_tests/harness/impulse_run.hpp"
#include "rt_tests/harness/touching_script.hpp"
#include "runtime/bound_mesh.hpp"
#include "runtime/impulse_response.hpp"
#include "runtime/look.hpp"
#include "runtime/relief.hpp"
#include "runtime/surface.hpp"
#include "runtime/testing/search_bench.hpp"
#include "runtime/testing/split_surface.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::size_t promised = 1536;
constexpr std::size_t promised_of_tools = 6144;
constexpr std::size_t stack_bytes = 1 << 18;
constexpr unsigned char paint = 0xa5;

struct alignas(64) AlignedBlock {
  std::byte bytes[64];
};

const std::function<void()>* work_on_stack = nullptr;
void call_work() { (*work_on_stack)(); }

// bytes of a stack of its own, painted to its last byte, that were written to
std::size_t written_by(const std::function<void()>& work) {
  std::vector<unsigned char> stack(stack_bytes, paint);
  ucontext_t here{}, there{};
  REQUIRE(getcontext(&there) == 0);
  there.uc_stack.ss_sp = stack.data();
  there.uc_stack.ss_size = stack.size();
  there.uc_link = &here;
  work_on_stack = &work;
  makecontext(&there, call_work, 0);
  REQUIRE(swapcontext(&here, &there) == 0);
  const auto lowest = std::find_if(stack.begin(), stack.end(), [](unsigned char byte) { return byte != paint; });
  return static_cast<std::size_t>(stack.end() - lowest);
}

// what a call takes beyond one that does nothing
std::size_t depth_of(const std::function<void()>& work) {
  return written_by(work) - written_by([] {});
}

[[gnu::noinline]] void write_bytes(std::size_t bytes) {
  auto* const local = static_cast<volatile unsigned char*>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < bytes; ++i) {
    local[i] = 0;
  }
}

TEST_CASE("the depth of a stack is measured") {
  // beside the bytes there are a frame and a return address or two
  for (const std::size_t bytes : {200, 1000, 5000}) {
    const std::size_t depth = depth_of([bytes] { write_bytes(bytes); });
    CHECK(depth >= bytes);
    CHECK(depth <= bytes + 100);
  }
}

TEST_CASE("a step keeps below the promised depth, whatever it has to do") {
  for (const auto wavelet : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = wavelet});
    TestBody body(model, {.max_contacts = 20, .cached_factors = 2});
    const auto nodes = model.touchable();
    std::vector<float> force(60);
    const auto depth = [&](std::size_t first, std::size_t count, std::uint64_t work) {
      std::vector<Constraint> contacts;
      for (std::size_t i = 0; i < count; ++i) {
        contacts.push_back({nodes[first + i], {1e-3F, 0, -1e-3F}});
      }
      const Elastostatic::Response response{as_vec3(std::span(force).first(3 * count)), as_vec4(body.field())};
      Elastostatic::StepReport report;
      const std::size_t bytes = depth_of([&] { report = body.body().step(contacts, {work}, response); });
      CHECK(answered(report.status));
      return bytes;
    };
    // each set is coarser first, then fresh or made of the last one's factor, then cached
    std::size_t deepest = 0;
    for (const std::size_t count : {0, 1, 2, 19, 20}) {
      for (const std::size_t first : {0, 1, 5}) {
        for (const std::uint64_t work : {body.requirement().least_work, any_budget, any_budget}) {
          deepest = std::max(deepest, depth(first, count, work));
        }
      }
    }
    MESSAGE("deepest stack of a step: ", deepest, " bytes");
    CHECK(deepest > 100);
    CHECK(deepest < promised);
  }
}

TEST_CASE("a step of mixed contacts keeps below the same depth") {
  const TestModel model({.levels = 4});
  TestBody body(model, {.max_contacts = 20, .cached_factors = 2, .max_forces = 4, .mixed_contacts = true});
  const auto nodes = model.touchable();
  const std::vector<float> weight(4, 0.25F);
  const std::vector<Vec3> normal(4, {0, 0, 1});
  const Mask mask{std::span(nodes).subspan(30, 4), weight};
  const DirectedMask directed{std::span(nodes).subspan(8, 4), normal};
  const std::vector<Constraint> contacts = {{nodes[3], {1e-3F, 0, -1e-3F}},
                                            {0, {1e-3F, 0, 0}, Constraint::Kind::mask},
                                            {0, {1e-3F, 0, 0}, Constraint::Kind::normal},
                                            {nodes[8], {1, 0, 0}, Constraint::Kind::force}};
  std::vector<float> force(12);
  Elastostatic::Loads loads;
  loads.masks = {&mask, 1};
  loads.directed = {&directed, 1};
  const Elastostatic::Response response{as_vec3(std::span(force)), as_vec4(body.field())};
  for (const std::uint64_t work : {body.requirement().least_work, any_budget, any_budget}) {
    Elastostatic::StepReport report;
    const std::size_t bytes = depth_of([&] { report = body.body().step(contacts, loads, {work}, response); });
    MESSAGE("deepest stack of a step of mixed contacts: ", bytes, " bytes");
    CHECK(answered(report.status));
    CHECK(bytes < promised);
  }
}

TEST_CASE("a query of the surface keeps below 1 kB") {
  const TestModel model({.levels = 4});
  const Surface::Requirement need = Surface::required(model.model(), 3);
  std::vector<AlignedBlock> memory(need.bytes / sizeof(AlignedBlock) + 1);
  const Surface::Created created = Surface::create(model.model(), 3, std::as_writable_bytes(std::span(memory)));
  REQUIRE(created);
  const Surface& surface = created.surface;
  std::vector<Vec4> normal(surface.node_count(3));
  Surface::NearestNode node;
  Surface::NearestPoint point;
  for (const float x : {-1.0F, 0.0F, 0.09F}) {
    const std::size_t bytes = depth_of([&] {
      node = surface.nearest_node({x, 0.02F, -0.03F}, layout::node_touchable);
      point = surface.nearest_point({x, 0.02F, -0.03F});
      (void)surface.normals(3, {}, normal);
    });
    MESSAGE("deepest stack of a query: ", bytes, " bytes");
    CHECK(node.node != layout::none);
    CHECK(point.triangle != layout::none);
    CHECK(bytes < 1024);
  }
}

TEST_CASE("finer pictures and relief keep below 1 kB") {
  const TestModel model({.levels = 4});
  const SplitSurface split(model, 3, {2, FinerSurface::Rule::loop});
  const std::vector<Vec3> vertex(100, Vec3{0.01F, 0.02F, 0.11F});
  AlignedBytes memory(BoundMesh::required(split.surface, vertex.size()));
  const auto bound = BoundMesh::create(split.surface, vertex, {memory.data(), memory.size()});
  REQUIRE(bound);
  std::vector<Vec4> position(split.finer.vertex_count(2)), normal(position.size()), bound_position(vertex.size());
  const std::vector<Vec3> slope(position.size());
  std::vector<std::uint8_t> seen(split.surface.triangle_count(1));
  ContactBody::Contact contact;
  contact.node[1] = 1;
  contact.node[2] = 2;
  contact.weight[0] = contact.weight[1] = 0.5;
  contact.normal = contact.force = {0, 0, 1};
  bool right = false;
  const std::size_t bytes = depth_of([&] {
    right = look_at(split.surface, {}, {{0, 0, 1}, {0, 0, -1}}, seen).triangles > 0 &&
            split.finer.positions(2, {}, position) && split.finer.normals(2, position, normal) &&
            bound.mesh.positions({}, normal, seen, bound_position) &&
            relief_friction(split.finer, slope, 0.3, {1e-3, 0, 0}, {&contact, 1}) > 0;
  });
  MESSAGE("deepest stack of a finer picture: ", bytes, " bytes");
  CHECK(right);
  CHECK(bytes < 1024);
}

TEST_CASE("a search for candidates keeps below 3 kB") {
  DeformedBody body({.levels = 4, .touchable_above = -0.4}, 0.1F);
  const CandidateSearch::Limits limits{.max_tools = 2, .max_candidates = 16, .margin = 0.01};
  AlignedBytes memory(CandidateSearch::required(limits));
  auto created = CandidateSearch::create(limits, {memory.data(), memory.size()});
  REQUIRE(created);
  for (const double x : {0.05, -0.05, 0.001}) {
    const Tool tools[] = {{Shape::box({0.01, 0.02, 0.03}), {{x, 0, 0}, {1, 0, 0, 0}}},
                          {Shape::sphere(0.1), {{x, 0, 0.1}, {1, 0, 0, 0}}}};
    std::uint64_t work = 0;
    CandidateSearch::Found found;
    const std::size_t bytes = depth_of([&] {
      body.surface.update(body.displacement, work);
      found = created.search.find(body.surface, tools, work);
    });
    MESSAGE("deepest stack of a search: ", bytes, " bytes");
    CHECK(found.left_out > 0);
    CHECK(bytes < 3072);
  }
}

TEST_CASE("a step of tools keeps below what docs/touching.md promises, whatever they do") {
  const TestModel model({.levels = 4});
  const ContactBody::Limits limits = TouchingScript::limits(64, 30);
  const ContactBody::Requirement need = ContactBody::required(model.model(), limits);
  AlignedBytes memory(need.bytes);
  auto created = ContactBody::create(model.model(), limits, {memory.data(), memory.size()});
  REQUIRE(created);
  TouchingScript script(model.model(), need, 7);
  std::size_t deepest = 0;
  for (int i = 0; i < 2000; ++i) {
    const TouchingScript::Cycle cycle = script.next(created.body);
    deepest = std::max(deepest, depth_of([&] { static_cast<void>(created.body.step(cycle.tools, {}, cycle.budget)); }));
  }
  MESSAGE("deepest stack of a step of tools: ", deepest, " bytes");
  CHECK(deepest > 1000);
  CHECK(deepest < promised_of_tools);
}

TEST_CASE("a step of impulses keeps below what docs/impulses.md promises") {
  const ModelFile file =
      encoded_file(synthetic_motion({.modes = 16, .groups = 3, .planes = 2, .alternating = true, .transfer_modes = 8}));
  const Model model = Model::open(file.bytes.span()).model;
  const ImpulseResponse::Requirement need = ImpulseResponse::required(model, {});
  AlignedBytes memory(need.bytes);
  auto created = ImpulseResponse::create(model, {}, {memory.data(), memory.size()});
  REQUIRE(created);
  std::vector<float> coordinate(16), velocity(16);
  std::vector<Vec3> displacement(101), colour(101);
  ImpulseScript script(model, need, 3);
  std::size_t deepest = 0;
  for (int i = 0; i < 2000; ++i) {
    const ImpulseScript::Cycle cycle = script.next();
    const std::span<Vec3> moved = std::span(displacement).first(cycle.vertices);
    const std::span<Vec3> lit = std::span(colour).first(cycle.lit ? cycle.vertices : 0);
    deepest = std::max(deepest, depth_of([&] {
                         static_cast<void>(created.body.step(cycle.impulse, cycle.budget,
                                                             {coordinate, velocity, moved, {}, {}, lit, &cycle.light}));
                       }));
  }
  MESSAGE("deepest stack of a step of impulses: ", deepest, " bytes");
  CHECK(deepest > 100);
  CHECK(deepest < 1536);
}

}  // namespace
}  // namespace greenloop
