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

// a body and what it answered last
class Answer {
 public:
  Answer(const Model& model, const Elastostatic::Limits& limits)
      : field_memory_(std::size_t{16} * model.node_count()),
        floats_(std::size_t{4} * model.node_count()),
        arena_(Elastostatic::required(model, limits).bytes) {
    auto created = Elastostatic::create(model, limits, {arena_.data(), arena_.size()});
    REQUIRE(created);
    body_ = created.body;
  }

  void step(const std::vector<Constraint>& contacts, std::uint64_t work) {
    force_.resize(3 * contacts.size());
    auto* const field = reinterpret_cast<float*>(field_memory_.data());
    report = body_.step(contacts, {.work = work}, {as_vec3(force_), as_vec4({field, floats_})});
    REQUIRE(answered(report.status));
  }

  [[nodiscard]] Eigen::Vector3d displacement(std::size_t node) const {
    const auto* at = reinterpret_cast<const float*>(field_memory_.data()) + 4 * node;
    return {double{at[0]}, double{at[1]}, double{at[2]}};
  }
  [[nodiscard]] double force_error(const Eigen::VectorXd& wanted) const {
    const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXf>(force_.data(), wanted.size()).cast<double>();
    return (found - wanted).norm() / wanted.norm();
  }

  Elastostatic::StepReport report;

 private:
  std::vector<float> force_;
  AlignedBytes field_memory_;
  std::size_t floats_;
  AlignedBytes arena_;
  Elastostatic body_;
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

// calls visit(site, its contacts, limits that just hold them, budget) from the least budget to more than enough
template <class Visit>
void visit_budgets(const test::Body& body, const ExactContacts& exact, const Model& model, Elastostatic::Limits limits,
                   Visit visit) {
  for (std::size_t s = 0; s < exact.sites().size(); ++s) {
    if (exact.sites()[s].rows.size() > most_contacts) continue;
    const auto contacts = contacts_of(body, exact.sites()[s], 0);
    limits.max_contacts = static_cast<std::uint32_t>(contacts.size());
    const auto need = Elastostatic::required(model, limits);
    const auto most = 2 * static_cast<double>(need.worst_work[model.level_count() - 1]);
    for (auto work = static_cast<double>(need.least_work); work < most; work *= 1.07) {
      visit(s, contacts, limits, static_cast<std::uint64_t>(work));
    }
  }
}

void check_loop(const test::Body& body, const ExactContacts& exact, layout::Wavelet wavelet) {
  const test::File file(test::model_of(body, wavelet, {.threshold = 0.01, .quantum = 0.005}));
  const CompressedCompliance<3> compressed(file.view);
  const AnsweredContacts measured(file.view, compressed, exact);
  const auto opened = Model::open(file.bytes.span());
  REQUIRE(opened);
  const Elastostatic::Limits at_once{.cached_factors = 1, .glide_cycles = 1, .refining_work = 0};
  std::set<std::uint32_t> levels, cuts;
  const auto compare = [&](std::size_t s, const auto& contacts, const auto& limits, std::uint64_t work) {
    Answer answer(opened.model, limits);
    answer.step(contacts, work);
    const Elastostatic::StepReport& report = answer.report;
    levels.insert(report.constraint_level);
    cuts.insert(report.field_level);
    const AnswerError error = measured.site_errors(s, report.constraint_level, report.field_level).front();
    CAPTURE(s);
    CAPTURE(report.constraint_level);
    CAPTURE(report.field_level);
    CHECK(std::abs(answer.force_error(exact.force(s).col(0)) - error.force) < 1e-4 * (1 + error.force));
    const FieldErrors field = field_errors(body, answer, exact.field(s).col(0));
    CHECK(std::abs(field.field - error.field) < 1e-4 * (1 + error.field));
    CHECK(std::abs(field.peak - error.peak) < 1e-4 * (1 + error.peak));
  };
  visit_budgets(body, exact, opened.model, at_once, compare);
  CHECK(levels.size() > 1);
  CHECK(cuts.size() > 1);
}

TEST_CASE("the loop answers patterns with the errors that are measured for its constraint level and cut field") {
  const auto body = test::make_body(2);
  const auto exact = solve(body);
  for (const layout::Wavelet wavelet : {layout::Wavelet::linear, layout::Wavelet::equilibrated}) {
    CAPTURE(wavelet);
    check_loop(body, exact, wavelet);
  }
}

// the worst errors of the sites that the loop is given below
void measure(const ExactContacts& exact, ModelData& model) {
  const test::File file(model);
  const CompressedCompliance<3> compressed(file.view);
  const AnsweredContacts measured(file.view, compressed, exact);
  const auto worst = [&](std::uint32_t level, std::uint32_t details, double AnswerError::*which) {
    double result = 0;
    for (const AnswerError& error : measured.all_errors(level, details)) result = std::max(result, error.*which);
    return static_cast<float>(result);
  };
  const std::uint32_t finest = file.view.levels - 1;
  for (std::uint32_t q = 0; q <= finest; ++q) {
    auto& counts = model.levels[q].counts;
    counts.field_error = worst(q, finest, &AnswerError::field);
    counts.force_error = worst(q, finest, &AnswerError::force);
    counts.cut_error = worst(model.info.coarsest_constraint_level, q, &AnswerError::field);
  }
}

TEST_CASE("no answer is further from the exact one than its report says: coarse, cut and gliding ones") {
  const auto body = test::make_body(2);
  const auto exact = solve(body);
  ModelData data = test::model_of(body, layout::Wavelet::linear, {.threshold = 0.01, .quantum = 0.005});
  measure(exact, data);
  const test::File file(data);
  const auto opened = Model::open(file.bytes.span());
  REQUIRE(opened);
  int gliding = 0, cut = 0, tight = 0;
  const auto compare = [&](std::size_t s, const auto& contacts, const auto& limits, std::uint64_t work) {
    Answer answer(opened.model, limits);
    // from the answer that fits to a finer one
    for (const std::uint64_t budget : {work, work, ~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}}) {
      answer.step(contacts, budget);
      const Elastostatic::StepReport& report = answer.report;
      CAPTURE(s);
      CAPTURE(report.constraint_level);
      CAPTURE(report.field_level);
      CAPTURE(report.details.glide);
      const double error =
          std::max(answer.force_error(exact.force(s).col(0)), field_errors(body, answer, exact.field(s).col(0)).field);
      CHECK(error <= double{report.error} * (1 + 1e-3) + 1e-4);
      gliding += report.details.glide < 1 ? 1 : 0;
      cut += report.field_level + 1 < file.view.levels ? 1 : 0;
      tight += error > 0.5 * double{report.error} ? 1 : 0;
    }
  };
  visit_budgets(body, exact, opened.model, {.cached_factors = 4, .glide_cycles = 4}, compare);
  CHECK(gliding > 10);
  CHECK(cut > 10);
  CHECK(tight > 10);
}

}  // namespace
}  // namespace greenloop::offline
