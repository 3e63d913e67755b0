#include "rt_tests/stress/heaviest_step.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {
namespace {

std::vector<Constraint> spread_contacts(const ModelView& view, std::size_t most) {
  std::vector<std::uint32_t> touchable;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      if ((level.nodes[i].flags & layout::node_touchable) != 0) {
        touchable.push_back(level.node_begin + i);
      }
    }
  }
  std::vector<Constraint> contacts(std::min(most, touchable.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const float depth = 1e-5F * static_cast<float>(1 + i % 7);
    contacts[i] = {touchable[i * touchable.size() / contacts.size()], {depth, -depth, depth / 2}};
  }
  return contacts;
}

}  // namespace

std::int64_t instructions_of_heaviest_step(const Model& model, const Elastostatic::Limits& limits) {
  if (!instruction_counter::install()) {
    return -1;
  }
  AlignedBytes arena(Elastostatic::required(model, limits).bytes);
  auto created = Elastostatic::create(model, limits, {arena.data(), arena.size()});
  if (!created) {
    throw std::runtime_error("no body for this model and these limits");
  }
  AlignedBytes field(std::size_t{16} * model.node_count());
  const std::vector<Constraint> contacts = spread_contacts(model.view(), limits.max_contacts);
  std::vector<float> force(3 * contacts.size());
  const Elastostatic::Response response{force, {reinterpret_cast<float*>(field.data()), field.size() / sizeof(float)}};
  created.body.step({}, {~std::uint64_t{0}}, response);  // every library function has been called before
  instruction_counter::start();
  created.body.step(contacts, {~std::uint64_t{0}}, response);
  return static_cast<std::int64_t>(instruction_counter::stop());
}

}  // namespace greenloop
