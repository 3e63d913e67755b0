#include "rt_tests/stress/heaviest_step.hpp"

#include <algorithm>
#include <vector>

#include "rt_tests/harness/elastostatic_driver.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/touchable_nodes.hpp"
#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {
namespace {

std::vector<Constraint> spread_contacts(const ModelView& view, std::size_t most) {
  const std::vector<std::uint32_t> touchable = touchable_nodes(view);
  std::vector<Constraint> contacts(std::min(most, touchable.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float depth = 1e-5F * static_cast<float>(1 + i % 7);
    contacts[i] = {touchable[i * touchable.size() / contacts.size()], {depth, -depth, depth / 2}};
  }
  return contacts;
}

}  // namespace

template <Driver D>
std::int64_t instructions_of_heaviest_step(const Model& model, std::uint32_t contacts, std::uint32_t factors) {
  if (!instruction_counter::install()) {
    return -1;
  }
  Hosted<typename D::Solver> host(model, D::limits(contacts, factors));
  const std::vector<Constraint> spread = spread_contacts(model.view(), contacts);
  std::vector<Vec3> force(spread.size());
  const typename D::Solver::Response response{force, as_vec4(host.field())};
  host.body().step({}, {~std::uint64_t{0}}, response);  // every library function has been called before
  instruction_counter::start();
  host.body().step(spread, {~std::uint64_t{0}}, response);
  return static_cast<std::int64_t>(instruction_counter::stop());
}

template std::int64_t instructions_of_heaviest_step<ElastostaticDriver>(const Model&, std::uint32_t, std::uint32_t);

}  // namespace greenloop
