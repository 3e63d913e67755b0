#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/measure/pattern_errors.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
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

std::vector<Constraint> contacts_of(const test::Body& body, const ContactSite& site, Eigen::Index sample) {
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < site.rows.size(); ++i) {
    contacts.push_back({static_cast<std::uint32_t>(body.column_nodes[site.rows[i]]), {}});
    for (std::size_t k = 0; k < 3; ++k) {
      contacts.back().value[k] = static_cast<float>(site.displacement(static_cast<Eigen::Index>(3 * i + k), sample));
    }
  }
  return contacts;
}

// what a body that has answered nothing yet does within a budget
struct Answer {
  Answer(const Model& model, const std::vector<Constraint>& contacts, std::uint64_t work)
      : force(3 * contacts.size()), field_memory(std::size_t{16} * model.node_count()) {
    const Elastostatic::Limits limits{
        .max_contacts = most_contacts, .cached_factors = 1, .glide_cycles = 1, .refining_work = 0};
    AlignedBytes memory(Elastostatic::required(model, limits).bytes);
    auto created = Elastostatic::create(model, limits, {memory.data(), memory.size()});
    REQUIRE(created);
    auto* const field = reinterpret_cast<float*>(field_memory.data());
    report = created.body.step(contacts, {.work = work}, {force, {field, std::size_t{4} * model.node_count()}});
  }
  [[nodiscard]] Eigen::Vector3d displacement(std::size_t node) const {
    const auto* at = reinterpret_cast<const float*>(field_memory.data()) + 4 * node;
    return {double{at[0]}, double{at[1]}, double{at[2]}};
  }
  Elastostatic::StepReport report;
  std::vector<float> force;
  AlignedBytes field_memory;
};

struct FieldErrors {
  double field = 0, peak = 0;
};
FieldErrors field_errors(const test::Body& body, const Answer& answer, const Eigen::VectorXd& exact) {
  double off = 0, norm = 0, largest_off = 0, largest = 0;
  for (std::size_t row = 0; row < body.column_nodes.size(); ++row) {
    const std::size_t node = body.column_nodes[row];
    const Eigen::Vector3d u = exact.segment<3>(static_cast<Eigen::Index>(3 * row));
    const double error = (answer.displacement(node) - u).squaredNorm();
    off += body.area[node] * error;
    norm += body.area[node] * u.squaredNorm();
    largest_off = std::max(largest_off, error);
    largest = std::max(largest, u.squaredNorm());
  }
  return {std::sqrt(off / norm), std::sqrt(largest_off / largest)};
}

void check_loop(const test::Body& body, const ExactContacts& exact, layout::Wavelet wavelet) {
  const test::File file(test::model_of(body, wavelet, {.threshold = 0.01, .quantum = 0.005}));
  const CompressedCompliance compressed(file.view);
  const AnsweredContacts answered(file.view, compressed, exact);
  const auto opened = Model::open(file.bytes.span());
  REQUIRE(opened);
  const auto need = Elastostatic::required(opened.model, {.max_contacts = most_contacts});

  std::set<std::uint32_t> levels;
  for (std::size_t s = 0; s < exact.sites().size(); ++s) {
    const ContactSite& site = exact.sites()[s];
    if (site.rows.size() > most_contacts) continue;
    const auto contacts = contacts_of(body, site, 0);
    const Eigen::VectorXd wanted = exact.force(s).col(0);
    for (double work = static_cast<double>(need.least_work);
         work < 2 * static_cast<double>(need.worst_work[file.view.levels - 1]); work *= 1.5) {
      const Answer answer(opened.model, contacts, static_cast<std::uint64_t>(work));
      const Elastostatic::StepReport& report = answer.report;
      REQUIRE(greenloop::answered(report.status));
      if (report.details.finer_level != report.constraint_level || report.field_level + 1 < file.view.levels) continue;
      levels.insert(report.constraint_level);
      const Eigen::VectorXd found =
          Eigen::Map<const Eigen::VectorXf>(answer.force.data(), wanted.size()).cast<double>();
      const AnswerError error = answered.site_errors(s, report.constraint_level).front();
      CAPTURE(s);
      CAPTURE(report.constraint_level);
      CHECK(std::abs((found - wanted).norm() / wanted.norm() - error.force) < 1e-4 * (1 + error.force));
      const FieldErrors field = field_errors(body, answer, exact.field(s).col(0));
      CHECK(std::abs(field.field - error.field) < 1e-4 * (1 + error.field));
      CHECK(std::abs(field.peak - error.peak) < 1e-4 * (1 + error.peak));
    }
  }
  CHECK(levels.size() > 1);
}

TEST_CASE("the loop answers patterns with the errors that are measured for its constraint level") {
  const auto body = test::make_body(2);
  const auto exact = solve(body);
  for (const layout::Wavelet wavelet : {layout::Wavelet::linear, layout::Wavelet::equilibrated}) {
    CAPTURE(wavelet);
    check_loop(body, exact, wavelet);
  }
}

}  // namespace
}  // namespace greenloop::offline
