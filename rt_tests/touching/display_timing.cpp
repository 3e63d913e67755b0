// display_timing MODEL: what finer pictures of a pressed body cost, and what detail that is carried along is off by.
// Some nodes far from each other are pressed. Prints medians of thread CPU time over the vertices that are written, and
// for the nodes of the finest level, bound to coarser ones, how far they are from their own displacement.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include "formats/write/model_file.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/bound_mesh.hpp"
#include "runtime/look.hpp"
#include "runtime/testing/split_surface.hpp"

namespace greenloop {
namespace {

constexpr std::size_t repeats = 200;

std::vector<Vec4> pressed_field(const TestModel& model) {
  TestBody body(model, {.max_contacts = 8});
  const auto nodes = model.touchable();
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < 8; ++i) contacts.push_back({nodes[i * nodes.size() / 8], {-2e-3F, 1e-3F, 1e-3F}});
  if (!answered(body.step(contacts).status)) throw std::runtime_error("the model does not answer these contacts");
  const auto field = as_vec4(std::as_const(body).field());
  return {field.begin(), field.end()};
}

template <class Work>
double median_nanoseconds(Work work) {
  std::vector<double> times;
  for (std::size_t i = 0; i < repeats; ++i) times.push_back(1e3 * time_of(1, work));
  return bench::median(times);
}

void print(const char* what, std::size_t vertices, double nanoseconds) {
  std::printf("%-56s %8zu vertices %9.1f us %7.2f ns each\n", what, vertices, 1e-3 * nanoseconds,
              nanoseconds / static_cast<double>(vertices));
}

// the body from far along z, at a quarter of its width
Look from_above(const TestModel& model) {
  const layout::Info& info = *model.view().info;
  const float width = info.box_max[0] - info.box_min[0];
  return {{0.5F * (info.box_max[0] + info.box_min[0]), 0.5F * (info.box_max[1] + info.box_min[1]),
           info.box_max[2] + 4 * width},
          {0, 0, -1},
          0.95F,
          2e-3F};
}

void time_finer(const TestModel& model, const std::vector<Vec4>& field, FinerSurface::Rule rule, const char* name) {
  const std::uint32_t finest = model.view().levels - 1;
  const SplitSurface split(model, finest, {2, rule});
  std::vector<std::uint8_t> seen(split.surface.triangle_count(1));
  Seen found;
  print("what is looked at", split.surface.node_count(finest),
        median_nanoseconds([&] { found = look_at(split.surface, field, from_above(model), seen); }));
  std::printf("    %u of %zu patches seen, %u halvings\n", found.triangles, seen.size(), found.halvings);
  for (std::uint32_t k = 1; k <= 2; ++k) {
    std::vector<Vec4> position(split.finer.vertex_count(k)), normal(position.size());
    print(name, position.size(), median_nanoseconds([&] { (void)split.finer.positions(k, field, position); }));
    print("    normals", position.size(), median_nanoseconds([&] { (void)split.finer.normals(k, position, normal); }));
  }
}

// the finest level's nodes, bound to the surface of a coarser one
void bind(const TestModel& model, const std::vector<Vec4>& field, std::uint32_t level) {
  const SplitSurface fine(model, model.view().levels - 1, {0, FinerSurface::Rule::midpoint});
  const SplitSurface coarse(model, level, {0, FinerSurface::Rule::midpoint});
  std::vector<Vec3> vertex;
  for (const Vec4& at : fine.positions(0)) vertex.push_back({at.x, at.y, at.z});
  AlignedBytes memory(BoundMesh::required(coarse.surface, vertex.size()));
  const auto bound = BoundMesh::create(coarse.surface, vertex, {memory.data(), memory.size()});
  if (!bound) throw std::runtime_error("the nodes are not bound");
  std::vector<Vec4> normal(coarse.surface.node_count(level)), position(vertex.size());
  (void)coarse.surface.normals(level, field, normal);
  print("bound vertices", vertex.size(),
        median_nanoseconds([&] { (void)bound.mesh.positions(field, normal, {}, position); }));
  double squares = 0, errors = 0, worst = 0, largest = 0;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    const Double3 rest{vertex[i].x, vertex[i].y, vertex[i].z}, u = exact(field[i]);
    const double error = norm(exact(position[i]) - rest - u);
    squares += dot(u, u), errors += error * error;
    worst = std::max(worst, error), largest = std::max(largest, norm(u));
  }
  std::printf("    on level %u: %.2f %% RMS off their own displacement, the worst %.1f %% of the largest\n", level,
              100 * std::sqrt(errors / squares), 100 * worst / largest);
}

void run(const char* file) {
  const TestModel model(load_file(file).span());
  const auto field = pressed_field(model);
  time_finer(model, field, FinerSurface::Rule::midpoint, "midpoints");
  time_finer(model, field, FinerSurface::Rule::loop, "Loop's rule");
  for (std::uint32_t level = model.view().levels - 1; level > 0; --level) bind(model, field, level);
}

}  // namespace
}  // namespace greenloop

int main(int count, char** argument) {
  if (count != 2) return 2;
  try {
    greenloop::run(argument[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "display_timing: %s\n", error.what());
    return 1;
  }
  return 0;
}
