#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

#include "offline/compress/dense_reference.hpp"
#include "offline/compress/exact_sample.hpp"
#include "offline/compress/pattern_errors.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t most_contacts = 16;

ExactContacts solve(const test::Body& body) {
  const SurfaceWavelet wavelet(body.mesh, body.flags, body.area, layout::Wavelet::linear);
  ExactContacts exact(contact_patterns(TouchedSurface(body.mesh, body.flags, body.area, wavelet), most_contacts, 2),
                      row_positions(body.mesh, wavelet, wavelet.finest()));
  exact.add(body.compliance, 0);
  exact.solve();
  exact.add_fields(body.compliance, 0);
  return exact;
}

std::vector<Contact> contacts_of(const test::Body& body, const ContactSite& site, Eigen::Index sample) {
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < site.rows.size(); ++i) {
    contacts.push_back({static_cast<std::uint32_t>(body.column_nodes[site.rows[i]]), {}});
    for (std::size_t k = 0; k < 3; ++k) {
      contacts.back().displacement[k] =
          static_cast<float>(site.displacement(static_cast<Eigen::Index>(3 * i + k), sample));
    }
  }
  return contacts;
}

// what a body that has answered nothing yet does within a budget
StepReport step(const Model& model, const std::vector<Contact>& contacts, std::uint64_t work,
                std::vector<float>& force) {
  const Limits limits{
      .max_contacts = most_contacts, .cached_factors = 1, .forces_only = true, .glide_cycles = 1, .refining_work = 0};
  AlignedBytes memory(Elastostatic::required(model, limits).bytes);
  auto created = Elastostatic::create(model, limits, {memory.data(), memory.size()});
  REQUIRE(created);
  force.resize(3 * contacts.size());
  return created.body.step(contacts, {.work = work}, {force, {}});
}

TEST_CASE("the loop answers patterns with the errors that are measured for its constraint level") {
  const auto body = test::make_body(2);
  const auto exact = solve(body);
  const test::File file(test::model_of(body, layout::Wavelet::linear, {.threshold = 0.01, .quantum = 0.005}));
  const CompressedCompliance compressed(file.view);
  const AnsweredContacts answered(file.view, compressed, exact);
  const auto opened = Model::open(file.bytes.span());
  REQUIRE(opened);
  const auto need = Elastostatic::required(opened.model, {.max_contacts = most_contacts, .forces_only = true});

  std::set<std::uint32_t> levels;
  std::vector<float> force;
  for (std::size_t s = 0; s < exact.sites().size(); ++s) {
    const ContactSite& site = exact.sites()[s];
    if (site.rows.size() > most_contacts) continue;
    const auto contacts = contacts_of(body, site, 0);
    const Eigen::VectorXd wanted = exact.force(s).col(0);
    for (double work = static_cast<double>(need.least_work);
         work < 2 * static_cast<double>(need.worst_work[file.view.levels - 1]); work *= 1.5) {
      const StepReport report = step(opened.model, contacts, static_cast<std::uint64_t>(work), force);
      REQUIRE(report.status <= Status::coarser);
      if (report.finer_level != report.constraint_level) continue;  // a mixed set
      levels.insert(report.constraint_level);
      const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXf>(force.data(), wanted.size()).cast<double>();
      const AnswerError error = answered.site_errors(s, report.constraint_level).front();
      CAPTURE(s);
      CAPTURE(report.constraint_level);
      CHECK(std::abs((found - wanted).norm() / wanted.norm() - error.force) < 1e-4 * (1 + error.force));
    }
  }
  CHECK(levels.size() > 1);
}

}  // namespace
}  // namespace greenloop::offline
