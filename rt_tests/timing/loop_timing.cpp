// Times the kernels of the loop: medians of thread CPU time over many repetitions.
//   loop_timing [MODEL.gloop]      without a model: a synthetic sphere
#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "formats/write/model_file.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// median over batches, so that the clock's own cost does not count
template <class Work>
double median_nanoseconds(int batch, Work work) {
  std::vector<double> times;
  for (int repeat = 0; repeat < 301; ++repeat) {
    int i = 0;
    times.push_back(1e3 * time_of(static_cast<std::size_t>(batch), [&] { work(i++); }));
  }
  std::nth_element(times.begin(), times.begin() + 150, times.end());
  return times[150];
}

// nodes near each other: those closest to a random one
std::vector<Constraint> patch(const TestModel& model, std::mt19937_64& random, std::size_t count) {
  const auto position = [&model](std::uint32_t node) { return node_record(model.view(), node).position; };
  std::vector<std::uint32_t> nodes = model.touchable();
  const float* centre = position(nodes[random() % nodes.size()]);
  const auto distance = [&](std::uint32_t node) {
    const float* x = position(node);
    float sum = 0;
    for (int r = 0; r < 3; ++r) {
      sum += (x[r] - centre[r]) * (x[r] - centre[r]);
    }
    return sum;
  };
  std::stable_sort(nodes.begin(), nodes.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < std::min(count, nodes.size()); ++i) {
    contacts.push_back({nodes[i], {1e-3F, 2e-4F, -3e-4F * static_cast<float>(i % 3)}});
  }
  return contacts;
}

void time_steps(const TestModel& model, std::size_t count) {
  std::mt19937_64 random(3);
  TestBody body(model, {.max_contacts = static_cast<std::uint32_t>(count), .cached_factors = 1});
  const auto a = patch(model, random, count);
  const auto b = patch(model, random, count);
  Elastostatic::StepReport report;
  const double cached = median_nanoseconds(20, [&](int) { report = body.step(a, any_budget); });
  const double force = median_nanoseconds(20, [&](int) { body.step(a, any_budget, false); });
  Elastostatic::StepReport fresh_report;
  const double fresh = median_nanoseconds(4, [&](int i) { fresh_report = body.step(i % 2 == 0 ? a : b, any_budget); });
  std::printf(
      "%3zu contacts: cached %8.0f ns (%7llu units, %.3f ns/unit)  forces only %7.0f ns  fresh %9.0f ns "
      "(%8llu units, %.3f ns/unit)\n",
      count, cached, static_cast<unsigned long long>(report.work), cached / static_cast<double>(report.work), force,
      fresh, static_cast<unsigned long long>(fresh_report.work), fresh / static_cast<double>(fresh_report.work));
}

void time_kernels(const TestModel& model) {
  const ModelView& view = model.view();
  const PlacedBody placed(view, 16);
  Body& body = *placed.body;
  std::vector<Float4> x(view.node_count);
  std::mt19937_64 random(3);
  const auto contacts = patch(model, random, 16);
  const std::uint32_t c = view.levels - 1;
  resolve_contacts(contacts, view, body.facts, {c}, body.resolution, body.planned);
  const double touching = median_nanoseconds(20, [&](int) {
    clear(body.touched);
    touch(body.refinement, body.planned.column, body.planned.columns, body.touched);
  });
  SetCounts counts;
  count_factor(body.planned.all(), body.touched, body.cost, body.stored, counts);
  const auto blocks = static_cast<double>(count_field_blocks(body.field_blocks, body.touched, c));
  const std::vector<float> force(3 * contacts.size(), 1e-3F);
  const ColumnForces forces{body.planned.columns, body.planned.column, force.data()};
  const double field = median_nanoseconds(20, [&](int) {
    compute_field<3>(body.field_model(), forces, body.touched, {c, c}, body.field_scratch(), x.data());
  });
  std::vector<Float4> matrix(144 * 16);
  const double capacitance = median_nanoseconds(2, [&](int) {
    assemble_capacitance(body.refinement, {body.planned.columns, body.planned.column}, body.touched, body.capacitance,
                         body.force, 48, matrix.data());
  });
  const double transform = median_nanoseconds(20, [&](int) {
    inverse_transform<3>(view, body.offsets, {c, c}, body.field_sums.of_blocks, x.data());
  });
  std::printf("%u nodes, %u in the domain; 16 contacts touch %llu coefficients, %.0f blocks of the field\n",
              view.node_count, view.domain_count, static_cast<unsigned long long>(counts.coefficients), blocks);
  std::printf("touch               %8.0f ns\n", touching);
  std::printf("field               %8.0f ns, %6.3f ns/block\n", field, field / blocks);
  std::printf("inverse transform   %8.0f ns, %6.3f ns/node\n", transform, transform / view.domain_count);
  std::printf("capacitance column  %8.0f ns, %6.3f ns/meeting of %.0f\n", capacitance / body.planned.columns,
              capacitance / static_cast<double>(counts.column.meetings),
              static_cast<double>(counts.column.meetings) / body.planned.columns);
}

void run(const TestModel& model) {
  time_kernels(model);
  for (const std::size_t count : {1, 4, 16, 64}) {
    time_steps(model, count);
  }
}

}  // namespace
}  // namespace greenloop

int main(int argc, char** argv) {
  using namespace greenloop;
  if (argc > 1) {
    run(TestModel(load_file(argv[1]).span()));
  } else {
    run(TestModel(SyntheticOptions{.levels = 5, .touchable_above = 0.5}));
  }
  return 0;
}
