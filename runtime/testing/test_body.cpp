#include "runtime/testing/test_body.hpp"

#include <stdexcept>
#include <string>

namespace greenloop {

TestModel::TestModel(std::span<const std::byte> bytes) : bytes_(bytes) {
  const auto opened = Model::open(bytes_.span());
  if (!opened) {
    throw std::runtime_error(std::string("test model refused at ") + opened.result.field);
  }
  model_ = opened.model;
}

std::vector<Constraint> patch(const TestModel& model, std::size_t first, std::size_t count) {
  const auto nodes = model.touchable();
  std::vector<Constraint> contacts;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto u = static_cast<float>(1 + i % 5);
    contacts.push_back({nodes[i % nodes.size()], {1e-4F * u, -2e-4F, 5e-5F * u}});
  }
  return contacts;
}

ModelData indefinite_model(const SyntheticOptions& options) {
  ModelData data = synthetic_model(options);
  data.info.quantum[0] = 1;
  std::uint32_t place = 0;
  for (LevelData& level : data.levels) {
    CouplingsData& couplings = level.couplings[0];
    const auto columns = static_cast<std::uint32_t>(couplings.begin.size() - 1);
    couplings = {.begin = std::vector<std::uint32_t>(columns + std::size_t{1}, 0), .index = {}, .value = {}};
    for (std::uint32_t j = 1; &level == &data.levels.back() && j < columns; ++j) {
      couplings.index.push_back(place + j - 1);
      couplings.begin[j + std::size_t{1}] = j;
    }
    couplings.value.resize(9 * couplings.index.size(), 30000);
    place += columns;
  }
  return data;
}

std::uint64_t hash_bytes(std::uint64_t hash, std::span<const std::byte> bytes) {
  Fnv1a chained(hash);
  chained.add(bytes);
  return chained.value();
}

std::uint64_t least_budget_of_finest(const TestModel& model, const Elastostatic::Limits& limits,
                                     std::span<const Constraint> contacts, bool with_field) {
  TestBody body(model, limits);
  std::uint64_t too_small = body.requirement().least_work - 1, enough = any_budget;
  while (enough - too_small > 1) {
    const std::uint64_t middle = too_small + (enough - too_small) / 2;
    body.renew();
    const bool is_finest = body.step(contacts, middle, with_field).status == Status::ok;
    (is_finest ? enough : too_small) = middle;
  }
  return enough;
}

std::uint64_t hash_step(std::uint64_t hash, const Elastostatic::StepReport& report, std::span<const float> force,
                        std::span<const float> field) {
  const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status),
                                 report.constraint_level,
                                 report.constraint_level,
                                 report.details.held_contacts,
                                 report.field_level,
                                 report.work,
                                 report.details.cached_factor ? 1U : 0U};
  hash = hash_bytes(hash, std::as_bytes(std::span(facts)));
  hash = hash_bytes(hash, std::as_bytes(force));
  return hash_bytes(hash, std::as_bytes(field));
}

}  // namespace greenloop
