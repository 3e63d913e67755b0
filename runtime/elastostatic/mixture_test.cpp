#include "runtime/elastostatic/mixture.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// a choice of whole groups of a level's set, each with even odds
std::vector<char> random_choice(const ContactSet& set, std::size_t contacts, std::mt19937_64& random) {
  std::vector<char> of_group(set.columns), of_contact;
  for (char& fine : of_group) {
    fine = static_cast<char>(random() % 2);
  }
  for (std::size_t i = 0; i < contacts; ++i) {
    of_contact.push_back(of_group[set.place[i]]);
  }
  return of_contact;
}

// forces of contacts as they are resolved, by a fresh factor; none if that is not positive definite
std::vector<float> solve(Body& body, const std::vector<Constraint>& contacts, const Resolution& resolution) {
  ContactSet& set = body.planned;
  resolve_contacts(contacts, *body.view, body.facts, resolution, body.resolution, set);
  clear(body.touched);
  touch(body.refinement, set.column, set.columns, body.touched);
  const std::uint32_t stride = body.cache.stride();
  std::vector<Float4> matrix(std::size_t{stride} * stride / 4), x(stride / 4);
  assemble_capacitance(body.refinement, {set.columns, set.column}, body.touched, body.capacitance, body.force, stride,
                       matrix.data());
  if (!cholesky_factor(3 * set.columns, stride, matrix.data())) {
    return {};
  }
  average_displacements(contacts, set, reinterpret_cast<float*>(x.data()));
  cholesky_solve(3 * set.columns, stride, matrix.data(), x.data());
  std::vector<float> force(3 * contacts.size());
  share_forces(reinterpret_cast<const float*>(x.data()), contacts.size(), set, force.data());
  return force;
}

TEST_CASE("every mixture of a level and the finest is positive definite and agrees with dense matrices") {
  for (const layout::Wavelet wavelet : layout::wavelets) {
    const ModelData data = synthetic_model({.levels = 4, .wavelet = wavelet});
    const TestModel model(encode(data));
    const DenseReference reference(data);
    const PlacedBody placed(model.view(), 40);
    Body& body = *placed.body;
    std::mt19937_64 random(17);
    for (int trial = 0; trial < 60; ++trial) {
      auto contacts = patch(model, random() % 100, 10 + random() % 31);
      std::shuffle(contacts.begin(), contacts.end(), random);
      const std::uint32_t c = static_cast<std::uint32_t>(trial) % 3;
      resolve_contacts(contacts, model.view(), body.facts, {c}, body.resolution, body.planned);
      const std::vector<char> choice = random_choice(body.planned, contacts.size(), random);
      const Resolution resolution{c, reinterpret_cast<const bool*>(choice.data())};
      const std::vector<float> force = solve(body, contacts, resolution);
      REQUIRE(force.size() == 3 * contacts.size());
      CHECK(std::is_sorted(body.planned.column, body.planned.column + body.planned.columns));
      const DenseAnswer dense = solve_dense(model.view(), reference, resolution, contacts);
      const Eigen::Map<const Eigen::VectorXf> computed(force.data(), dense.force.size());
      const double error = (computed.cast<double>() - dense.force).cwiseAbs().maxCoeff();
      CHECK(error <= 60 * dense.condition * 0x1p-24 * dense.force.cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE(
    "the largest force of the last answer comes first, and what was chosen stays unless others are twice as large") {
  const TestModel model({.levels = 4});
  const PlacedBody placed(model.view(), 40);
  Body& body = *placed.body;
  const auto contacts = patch(model, 20, 40);
  resolve_contacts(contacts, model.view(), body.facts, {1}, body.resolution, body.planned);
  REQUIRE(body.planned.columns >= 4);
  std::vector<float> force(3 * contacts.size());
  const auto rank_after = [&](auto force_of_group) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const std::uint32_t k = body.planned.place[i];
      force[3 * i] = force_of_group(k) / static_cast<float>(body.planned.members[k]);
    }
    body.last.remember(contacts, body.planned, force.data());
    body.mixture.rank(contacts, body.planned, body.facts, body.last);
    std::vector<std::uint32_t> columns;
    for (std::uint32_t g = 0; g < body.mixture.groups(); ++g) {
      columns.push_back(body.mixture.column(g));
    }
    return columns;
  };
  const std::uint32_t n = body.planned.columns;
  const std::vector<std::uint32_t> increasing(body.planned.column, body.planned.column + n);
  CHECK(rank_after([&](std::uint32_t k) { return static_cast<float>(n - k); }) == increasing);
  std::vector<std::uint32_t> last_first = increasing;
  std::rotate(last_first.begin(), last_first.end() - 1, last_first.end());
  CHECK(rank_after([&](std::uint32_t k) { return k + 1 == n ? 1.1F : 1.0F; }) == last_first);
  body.mixture.choose(0);
  body.mixture.remember(true, 1, contacts, body.facts);
  CHECK(body.mixture.has_last());
  CHECK(rank_after([&](std::uint32_t k) { return k == 0 ? 1.9F : 1.0F; }) == last_first);
  CHECK(rank_after([&](std::uint32_t k) { return k == 0 ? 2.1F : 1.0F; })[0] == increasing[0]);
  body.mixture.remember(false, 1, contacts, body.facts);
  CHECK_FALSE(body.mixture.has_last());
  CHECK(rank_after([&](std::uint32_t k) { return k == 0 ? 1.9F : 1.0F; })[0] == increasing[0]);
}

double distance(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  double norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += std::pow(double{a[i]} - b[i], 2);
    norm += std::pow(double{b[i]}, 2);
  }
  return std::sqrt(sum / norm);
}

// the touchable nodes next to one, displaced by a linear function of their places
std::vector<Constraint> smooth_patch(const TestModel& model, std::size_t first, std::size_t count) {
  const auto nodes = model.touchable();
  const auto position = [&](std::uint32_t node) {
    return Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(node_record(model.view(), node).position));
  };
  const Eigen::Vector3f centre = position(nodes[first % nodes.size()]);
  std::vector<std::pair<float, std::uint32_t>> near;
  for (const std::uint32_t node : nodes) {
    near.emplace_back((position(node) - centre).norm(), node);
  }
  std::sort(near.begin(), near.end());
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f x = (position(near[i].second) - centre) / near[count].first;
    contacts.push_back({near[i].second, {1e-4F * (1 - x[1]), 1e-4F * (x[0] + x[2] / 2), -2e-4F + 5e-5F * x[1]}});
  }
  return contacts;
}

// mean error of the forces, against those of the finest level, with a part of the contacts there, by groups in an order
// that `weight` decides: (group of the set, its force, its contacts)
template <class Weight>
double order_error(const TestModel& model, Body& body, bool smooth, double part, Weight weight) {
  constexpr int patches = 20;
  const std::uint32_t finest = model.view().levels - 1;
  double sum = 0;
  for (int trial = 0; trial < patches; ++trial) {
    const auto first = static_cast<std::size_t>(13 * trial);
    const auto contacts = smooth ? smooth_patch(model, first, 40) : patch(model, first, 40);
    const std::vector<float> exact = solve(body, contacts, {finest});
    const std::vector<float> coarse = solve(body, contacts, {finest - 1});
    const std::vector<std::uint32_t> place(body.planned.place, body.planned.place + contacts.size());
    std::vector<std::vector<std::size_t>> groups(body.planned.columns);
    std::vector<Eigen::Vector3f> force(body.planned.columns, Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      groups[place[i]].push_back(i);
      force[place[i]] += Eigen::Map<const Eigen::Vector3f>(coarse.data() + 3 * i);
    }
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < groups.size(); ++k) {
      order.emplace_back(-weight(contacts, groups[k], force[k]), k);
    }
    std::sort(order.begin(), order.end());
    std::vector<char> fine(contacts.size());
    std::size_t chosen = 0;
    for (const auto& [key, k] : order) {
      const bool fits = static_cast<double>(chosen + groups[k].size()) <= part * static_cast<double>(contacts.size());
      for (const std::size_t i : groups[k]) {
        fine[i] = static_cast<char>(fits);
        chosen += fits ? 1 : 0;
      }
    }
    sum += distance(solve(body, contacts, {finest - 1, reinterpret_cast<const bool*>(fine.data())}), exact);
  }
  return sum / patches;
}

struct OrderErrors {
  double by_force, by_chance, by_deviation;
};

OrderErrors order_errors(const TestModel& model, bool smooth, double part) {
  const PlacedBody placed(model.view(), 40);
  std::mt19937_64 random(3);
  const auto error = [&](auto weight) { return order_error(model, *placed.body, smooth, part, weight); };
  const OrderErrors errors{
      error([](const auto&, const auto&, const Eigen::Vector3f& f) { return f.squaredNorm(); }),
      error([&](const auto&, const auto&, const auto&) { return static_cast<double>(random() % 1000); }),
      error([](const std::vector<Constraint>& contacts, const auto& group, const auto&) {
        Eigen::Vector3f mean = Eigen::Vector3f::Zero();
        double sum = 0;
        for (const std::size_t i : group) {
          mean += Eigen::Map<const Eigen::Vector3f>(contacts[i].value) / static_cast<float>(group.size());
        }
        for (const std::size_t i : group) {
          sum += (Eigen::Map<const Eigen::Vector3f>(contacts[i].value) - mean).squaredNorm();
        }
        return sum;
      })};
  const std::string kind = smooth ? "smooth" : "rough";
  MESSAGE(kind, ", ", part, " of the contacts at the finest level: error by force ", errors.by_force, ", by chance ",
          errors.by_chance, ", by deviation ", errors.by_deviation);
  return errors;
}

TEST_CASE("large forces come first: where displacements are smooth, chance and deviation leave larger errors") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  for (const double part : {0.25, 0.5, 0.75}) {
    const OrderErrors smooth = order_errors(model, true, part);
    CHECK(smooth.by_force < smooth.by_chance);
    CHECK(smooth.by_force < smooth.by_deviation);
    const OrderErrors rough = order_errors(model, false, part);
    CHECK(rough.by_deviation < rough.by_force);
  }
}

// whether the forces of a mixed step are those of a fresh factor of its set
bool agrees(const Body& body, const Elastostatic::StepReport& report, const std::vector<Constraint>& contacts,
            std::span<const float> force, Body& other) {
  std::vector<char> fine;
  for (const Constraint& contact : contacts) {
    fine.push_back(static_cast<char>(body.facts[contact.node].fine));
  }
  const Resolution resolution{report.constraint_level, reinterpret_cast<const bool*>(fine.data())};
  return distance(force, solve(other, contacts, resolution)) <= 1e-3;
}

struct Slide {
  double error = 0;  ///< of the forces, against the finest level, a mean
  std::uint32_t mixed = 0;
  std::uint32_t finest = 0;
  std::uint32_t fine_contacts = 0;  ///< most in a mixed set
  std::uint64_t digest = empty_hash;
};

// a patch that moves on by a node in every step
Slide slide(const TestModel& model, std::uint64_t budget, std::uint64_t refining_work, std::uint32_t steps) {
  const Elastostatic::Limits limits{.max_contacts = 32, .refining_work = refining_work};
  TestBody body(model, limits), exact(model, {.max_contacts = 32, .glide_cycles = 1});
  const std::uint32_t finest = model.view().levels - 1;
  Slide result;
  for (std::uint32_t step = 0; step < steps; ++step) {
    const auto contacts = patch(model, step, 32);
    REQUIRE(exact.step(contacts, any_budget).status == Status::ok);
    const Elastostatic::StepReport report = body.step(contacts, budget);
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
    CHECK((report.details.finer_level == report.constraint_level) ==
          (report.details.finer_contacts == contacts.size()));
    const bool mixed = report.details.finer_level != report.constraint_level;
    CHECK((!mixed || (report.details.finer_level == finest && report.status == Status::coarser)));
    result.mixed += mixed ? 1 : 0;
    result.finest += report.constraint_level == finest ? 1 : 0;
    result.fine_contacts =
        mixed ? std::max<std::uint32_t>(result.fine_contacts, report.details.finer_contacts) : result.fine_contacts;
    result.error += distance(body.force(), exact.force()) / steps;
    result.digest = hash_step(result.digest, report, body.force(), body.field());
  }
  return result;
}

TEST_CASE("contacts that change in every step are refined in part, within the budget") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  const std::uint64_t whole = TestBody(model, {.max_contacts = 32}).step(patch(model, 0, 32), any_budget).work;
  for (const std::uint64_t percent : {60U, 50U, 45U}) {
    const std::uint64_t budget = whole * percent / 100;
    const Slide mixed = slide(model, budget, ~std::uint64_t{0}, 40);
    const Slide coarse = slide(model, budget, 1, 40);
    MESSAGE("budget of ", percent, " %: ", mixed.mixed, " of 40 steps mixed, up to ", mixed.fine_contacts,
            " of 32 contacts, ", mixed.finest, " at the finest level; mean force error ", mixed.error,
            ", without refining ", coarse.error);
    CHECK(coarse.mixed == 0);
    CHECK(mixed.mixed > 0);
    CHECK(mixed.error < coarse.error);
    CHECK(slide(model, budget, ~std::uint64_t{0}, 40).digest == mixed.digest);
  }
}

TEST_CASE("a mixed factor that followed its contacts is that of its set") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  const PlacedBody placed(model.view(), 32);
  const std::uint64_t budget = TestBody(model, {.max_contacts = 32}).step(patch(model, 0, 32), any_budget).work / 2;
  TestBody stepped(model, {.max_contacts = 32, .glide_cycles = 1});
  const Body& body = *std::bit_cast<Body*>(stepped.body());
  std::uint32_t mixed = 0;
  std::uint32_t changed = 0;
  for (std::uint32_t step = 0; step < 40; ++step) {
    const auto contacts = patch(model, step, 32);
    const Elastostatic::StepReport report = stepped.step(contacts, budget);
    if (report.details.finer_level > report.constraint_level) {
      ++mixed;
      changed += report.details.changed_nodes > 0 ? 1 : 0;
      CHECK(agrees(body, report, contacts, stepped.force(), *placed.body));
    }
  }
  CHECK(mixed > 3);
  CHECK(changed > 3);
}

TEST_CASE("contacts that stay keep their mixture until the factor of the finest level is complete") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  TestBody body(model, {.max_contacts = 32});
  const std::uint64_t budget = TestBody(model, {.max_contacts = 32}).step(patch(model, 0, 32), any_budget).work / 2;
  Elastostatic::StepReport report;
  std::uint32_t at = 0;
  do {
    REQUIRE(at < 40);
    report = body.step(patch(model, at++, 32), budget);
  } while (report.details.finer_level == report.constraint_level);
  const std::uint32_t fine = report.details.finer_contacts;
  std::uint32_t stays = 0;
  while ((report = body.step(patch(model, at - 1, 32), budget)).constraint_level < 4) {
    REQUIRE(++stays < 100);
    CHECK(report.details.finer_contacts == fine);
    CHECK(report.details.cached_factor);
  }
  MESSAGE("finest level after ", stays, " steps more");
}

}  // namespace
}  // namespace greenloop
