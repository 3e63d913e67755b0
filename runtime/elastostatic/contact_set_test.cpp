#include "runtime/elastostatic/contact_set.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

struct Memory {
  Memory(const ModelView& view, std::size_t contacts)
      : facts(view.node_count),
        column(contacts),
        place(contacts),
        members(contacts),
        sorting(contacts),
        index_of_place(view.node_count, layout::none) {
    list_node_facts(view, facts.data());
    set.column = column.data();
    set.place = place.data();
    set.members = members.data();
    scratch.sorting = sorting.data();
    scratch.index_of_place = index_of_place.data();
  }
  std::vector<NodeFacts> facts;
  std::vector<std::uint32_t> column, place, members, sorting, index_of_place;
  ResolutionScratch scratch;
  ContactSet set;
};

TEST_CASE("contacts become sorted columns; those that share one are merged and share its force equally") {
  const TestModel model({.levels = 4});
  const ModelView& view = model.view();
  auto nodes = model.touchable();
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 50; ++trial) {
    std::shuffle(nodes.begin(), nodes.end(), random);
    std::vector<Constraint> contacts;
    const std::size_t touched = 1 + random() % 40;
    for (std::size_t i = 0; i < touched; ++i) {
      contacts.push_back({nodes[i], {static_cast<float>(i), 1.0F, -2.0F}});
    }
    Memory memory(view, contacts.size());
    REQUIRE(check_contacts(contacts, view.node_count, memory.facts.data(), {view.node_count, 0, {}}).status ==
            Status::ok);
    for (std::uint32_t c = 0; c < 4; ++c) {
      resolve_contacts(contacts, view, memory.facts.data(), {c}, memory.scratch, memory.set);
      const ContactSet& set = memory.set;
      REQUIRE(set.columns <= contacts.size());
      CHECK(std::adjacent_find(set.column, set.column + set.columns, std::greater_equal<>()) ==
            set.column + set.columns);
      const std::size_t components = std::size_t{3} * set.columns;
      std::vector<float> mean(components), total(components), force(components), shared(3 * contacts.size());
      average_displacements(contacts, set, mean.data());
      for (std::size_t k = 0; k < force.size(); ++k) {
        force[k] = static_cast<float>(k + 1);
      }
      share_forces(force.data(), contacts.size(), set, shared.data());
      std::vector<float> sum(set.columns);
      std::vector<std::uint32_t> count(set.columns);
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const std::uint32_t q = memory.facts[contacts[i].node].mesh_level;
        const std::uint32_t node = view.representatives[c][q][contacts[i].node - view.level[q].node_begin];
        CHECK(set.column[set.place[i]] == make_column(c, domain_place(view, node)));
        sum[set.place[i]] += contacts[i].value[0];
        ++count[set.place[i]];
        for (std::size_t r = 0; r < 3; ++r) {
          total[std::size_t{3} * set.place[i] + r] += shared[3 * i + r];
        }
      }
      for (std::size_t k = 0; k < set.columns; ++k) {
        CHECK(count[k] == set.members[k]);
        CHECK(mean[3 * k] == sum[k] / static_cast<float>(count[k]));
        CHECK(mean[3 * k + 2] == -2.0F);
        CHECK(total[3 * k] == doctest::Approx(force[3 * k]).epsilon(1e-6));
      }
      CHECK(std::all_of(memory.index_of_place.begin(), memory.index_of_place.end(),
                        [](std::uint32_t place) { return place == layout::none; }));
    }
  }
}

TEST_CASE("each fault of a contact has its name, and the check leaves no trace") {
  const TestModel model({.levels = 3});
  const ModelView& view = model.view();
  Memory memory(view, 4);
  const auto check = [&](std::vector<Constraint> contacts) {
    const CheckedContacts checked =
        check_contacts(contacts, view.node_count, memory.facts.data(), {view.node_count, 0, {}});
    CHECK(std::all_of(memory.facts.begin(), memory.facts.end(), [](const NodeFacts& f) { return !f.marked; }));
    CHECK((checked.refused == StepReport::no_constraint) == (checked.status == Status::ok));
    return checked.status;
  };
  const auto nodes = model.touchable();
  std::uint32_t untouchable = 0;
  while (std::find(nodes.begin(), nodes.end(), untouchable) != nodes.end()) {
    ++untouchable;
  }
  const Constraint good{nodes[0], {1, 2, 3}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  CHECK(check({good, {nodes[1], {}}}) == Status::ok);
  CHECK(check({good, {view.node_count, {}}}) == Status::held_out_of_range);
  CHECK(check({good, {0xffffffff, {}}}) == Status::held_out_of_range);
  CHECK(check({good, {untouchable, {}}}) == Status::held_not_touchable);
  CHECK(check({good, {nodes[1], {0, nan, 0}}}) == Status::held_not_finite);
  CHECK(check({good, {nodes[1], {0, 0, infinity}}}) == Status::held_not_finite);
  CHECK(check({good, {nodes[1], {-infinity, 0, 0}}}) == Status::held_not_finite);
  CHECK(check({good, {nodes[1], {}}, good}) == Status::held_duplicate);
}

TEST_CASE("displacements far below the size of an atom count as none") {
  const TestModel model({.levels = 1});
  Memory memory(model.view(), 1);
  const std::vector<Constraint> contacts = {{model.touchable()[0], {1e-40F, -1e-26F, 1e-20F}}};
  resolve_contacts(contacts, model.view(), memory.facts.data(), {0}, memory.scratch, memory.set);
  float mean[3];
  average_displacements(contacts, memory.set, mean);
  CHECK(mean[0] == 0);
  CHECK(mean[1] == 0);
  CHECK(mean[2] == 1e-20F);
}

}  // namespace
}  // namespace greenloop
