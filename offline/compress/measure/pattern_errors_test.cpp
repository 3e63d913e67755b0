#include "offline/compress/measure/pattern_errors.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using layout::PatternKind;

constexpr std::size_t sites = 4;

ExactContacts solve(const test::Body& body, std::uint32_t contacts) {
  const SurfaceWavelet wavelet(body.mesh, body.flags, body.area, layout::Wavelet::lifted_linear);
  ExactContacts exact(contact_patterns(TouchedSurface(body.mesh, body.flags, body.area, wavelet), contacts, sites),
                      row_positions(body.mesh, wavelet, wavelet.finest()));
  const auto stream = [&](auto&& take) {  // in pieces, as columns come
    for (std::size_t first = 0; first < wavelet.rows(); first += 50) {
      take(test::columns_of(body.compliance)(first, std::min<std::size_t>(50, wavelet.rows() - first)), first);
    }
  };
  stream([&](const Eigen::MatrixXd& block, std::size_t first) { exact.add(block, first); });
  exact.solve();
  stream([&](const Eigen::MatrixXd& block, std::size_t first) { exact.add_fields(block, first); });
  return exact;
}

const test::Body& body() {
  static const test::Body value = test::make_body(2);
  return value;
}

const ExactContacts& exact() {
  static const ExactContacts value = solve(body(), 16);
  return value;
}

struct Model {
  explicit Model(const ModelData& data) : file(data) {}
  test::File file;
  CompressedCompliance<3> compressed{file.view};
  AnsweredContacts answered{file.view, compressed, exact()};
};

ModelData model_at(double threshold, layout::Wavelet wavelet = layout::Wavelet::lifted_linear) {
  return test::model_of(body(), wavelet, {.threshold = threshold, .quantum = 0.5 * threshold});
}

const Model& coarse_model() {
  static const Model value(model_at(0.02));
  return value;
}

std::vector<Eigen::Index> unknowns(const std::vector<std::size_t>& rows) {
  std::vector<Eigen::Index> result;
  for (const std::size_t row : rows) {
    for (std::size_t k = 0; k < 3; ++k) result.push_back(static_cast<Eigen::Index>(3 * row + k));
  }
  return result;
}

double worst(const std::vector<AnswerError>& errors, double AnswerError::*which) {
  double result = 0;
  for (const auto& error : errors) result = std::max(result, error.*which);
  return result;
}

TEST_CASE("exact forces and fields are those of a dense solution") {
  REQUIRE(exact().sites().size() > 20);
  for (std::size_t s = 0; s < exact().sites().size(); ++s) {
    const ContactSite& site = exact().sites()[s];
    const auto at = unknowns(site.rows);
    const Eigen::MatrixXd force = body().compliance(at, at).partialPivLu().solve(site.displacement);
    const Eigen::MatrixXd field = body().compliance(Eigen::all, at) * force;
    CHECK((exact().force(s) - force).norm() < 1e-9 * force.norm());
    CHECK((exact().field(s) - field).norm() < 1e-9 * field.norm());
  }
}

TEST_CASE("spheres push only, and pierce none of their contacts") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  const TouchedSurface surface(body().mesh, body().flags, body().area, wavelet);
  std::size_t spheres = 0, released = 0;
  std::vector<ContactSite> asked = contact_patterns(surface, 16, sites);
  std::erase_if(asked, [](const ContactSite& site) { return !site.sphere; });
  for (std::size_t s = 0; s < exact().sites().size(); ++s) {
    const ContactSite& site = exact().sites()[s];
    if (!site.sphere) continue;
    const ContactSite& all = asked[spheres++];
    CHECK(all.contacts == site.contacts);
    released += all.rows.size() - site.rows.size();
    for (std::size_t i = 0; i < site.rows.size(); ++i) {
      const Eigen::Vector3d outward = body().mesh.positions[body().column_nodes[site.rows[i]]] - site.sphere->centre;
      CHECK(exact().force(s).col(0).segment<3>(static_cast<Eigen::Index>(3 * i)).dot(outward) > 0);
    }
    for (const std::size_t row : all.rows) {
      const Eigen::Vector3d x = body().mesh.positions[body().column_nodes[row]] +
                                exact().field(s).col(0).segment<3>(static_cast<Eigen::Index>(3 * row));
      CHECK((x - site.sphere->centre).norm() > (1 - 1e-5) * site.sphere->radius);
    }
  }
  CHECK(spheres == asked.size());
  CHECK(released > 0);
}

TEST_CASE("a model that leaves nothing out has next to no errors, one that is damaged has") {
  const Model fine(model_at(1e-5));
  const auto errors = fine.answered.all_errors(fine.compressed.finest());
  CHECK(worst(errors, &AnswerError::field) < 1e-3);
  CHECK(worst(errors, &AnswerError::peak) < 1e-3);
  CHECK(worst(errors, &AnswerError::force) < 1e-3);
  CHECK(worst(errors, &AnswerError::total_force) < 1e-3);

  ModelData damaged = model_at(1e-5);
  for (float& root : damaged.levels[1].scales.of<3>()[3].root) root *= 1.5F;
  const Model broken(damaged);
  const auto of_broken = broken.answered.all_errors(broken.compressed.finest());
  CHECK(worst(of_broken, &AnswerError::field) > 0.1);
  CHECK(worst(of_broken, &AnswerError::peak) > 0.1);
  CHECK(worst(of_broken, &AnswerError::force) > 0.1);
}

TEST_CASE("larger thresholds make larger errors") {
  const Model finer(model_at(0.005));
  const std::size_t finest = finer.compressed.finest();
  for (double AnswerError::*which : {&AnswerError::field, &AnswerError::peak, &AnswerError::force}) {
    CHECK(worst(finer.answered.all_errors(finest), which) <
          0.7 * worst(coarse_model().answered.all_errors(finest), which));
  }
}

// the answer at a level by the definitions, from dense matrices
class DenseAnswer {
 public:
  DenseAnswer(const Model& model, std::size_t level) : model_(model), level_(level) {
    const SurfaceWavelet& wavelet = model.compressed.wavelet();
    const auto dense = test::dense_compliances(model.file.view);
    const auto rows = static_cast<Eigen::Index>(3 * wavelet.row_end(level));
    compliance_ = dense[level];
    const Eigen::MatrixXd all = Eigen::MatrixXd(test::forward_transform(wavelet, wavelet.finest()));
    const Eigen::MatrixXd own = Eigen::MatrixXd(test::forward_transform(wavelet, level));
    const Eigen::MatrixXd form = all * dense.back() * all.transpose();
    field_ = all.partialPivLu().solve(form.leftCols(rows) * Eigen::MatrixXd(own.transpose().partialPivLu().inverse()));
  }

  [[nodiscard]] AnswerError error(const ContactSite& site, std::size_t s, Eigen::Index sample) const {
    std::map<std::size_t, std::vector<std::size_t>> members;  // contacts by representative's row
    for (std::size_t i = 0; i < site.rows.size(); ++i) members[representative(site.rows[i])].push_back(i);
    std::vector<std::size_t> rows;
    Eigen::VectorXd held(static_cast<Eigen::Index>(3 * members.size()));
    for (const auto& [row, contacts] : members) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const std::size_t i : contacts) mean += part(site.displacement.col(sample), i);
      held.segment<3>(static_cast<Eigen::Index>(3 * rows.size())) = mean / static_cast<double>(contacts.size());
      rows.push_back(row);
    }
    const auto at = unknowns(rows);
    const Eigen::VectorXd force = compliance_(at, at).partialPivLu().solve(held);
    Eigen::VectorXd shared(site.displacement.rows());
    std::size_t k = 0;
    for (const auto& [row, contacts] : members) {
      for (const std::size_t i : contacts) {
        shared.segment<3>(static_cast<Eigen::Index>(3 * i)) = part(force, k) / static_cast<double>(contacts.size());
      }
      ++k;
    }
    Eigen::VectorXd field = Eigen::VectorXd::Zero(field_.rows());
    for (std::size_t j = 0; j < at.size(); ++j) field += force[static_cast<Eigen::Index>(j)] * field_.col(at[j]);
    for (std::size_t i = 0; level_ == model_.compressed.finest() && i < site.rows.size(); ++i) {
      field.segment<3>(static_cast<Eigen::Index>(3 * site.rows[i])) = part(site.displacement.col(sample), i);
    }
    return compare(field, exact().field(s).col(sample), shared, exact().force(s).col(sample));
  }

 private:
  static Eigen::Vector3d part(const Eigen::VectorXd& all, std::size_t i) {
    return all.segment<3>(static_cast<Eigen::Index>(3 * i));
  }

  [[nodiscard]] std::size_t representative(std::size_t row) const {
    const std::size_t node = body().column_nodes[row];
    const auto& mesh = body().mesh;
    std::size_t q = 0;
    while (node >= mesh.vertex_end[q]) ++q;
    const std::size_t begin = q == 0 ? 0 : mesh.vertex_end[q - 1];
    const std::uint32_t found = model_.file.view.representatives[level_][q][node - begin];
    const auto place = std::lower_bound(body().column_nodes.begin(), body().column_nodes.end(), found);
    return static_cast<std::size_t>(place - body().column_nodes.begin());
  }

  static AnswerError compare(const Eigen::VectorXd& u, const Eigen::VectorXd& wanted, const Eigen::VectorXd& f,
                             const Eigen::VectorXd& wanted_force) {
    double off = 0, norm = 0, largest = 0, largest_off = 0;
    for (std::size_t row = 0; row < body().column_nodes.size(); ++row) {
      const double area = body().area[body().column_nodes[row]];
      const Eigen::Vector3d d = part(u, row) - part(wanted, row);
      off += area * d.squaredNorm();
      norm += area * part(wanted, row).squaredNorm();
      largest = std::max(largest, part(wanted, row).norm());
      largest_off = std::max(largest_off, d.norm());
    }
    AnswerError error;
    error.field = std::sqrt(off / norm);
    error.peak = largest_off / largest;
    error.force = (f - wanted_force).norm() / wanted_force.norm();
    return error;
  }

  const Model& model_;
  std::size_t level_;
  Eigen::MatrixXd compliance_, field_;
};

TEST_CASE("errors of every level are those of a dense computation with representatives and all details") {
  for (const layout::Wavelet wavelet : {layout::Wavelet::lifted_linear, layout::Wavelet::butterfly}) {
    const Model model(model_at(0.01, wavelet));
    for (std::size_t level = 0; level <= model.compressed.finest(); ++level) {
      CAPTURE(level);
      const DenseAnswer dense(model, level);
      for (std::size_t s = 0; s < exact().sites().size(); s += 3) {
        const auto found = model.answered.site_errors(s, level, model.compressed.finest());
        for (std::size_t k = 0; k < found.size(); ++k) {
          const AnswerError wanted = dense.error(exact().sites()[s], s, static_cast<Eigen::Index>(k));
          CHECK(found[k].field == doctest::Approx(wanted.field).epsilon(1e-4));
          CHECK(found[k].peak == doctest::Approx(wanted.peak).epsilon(1e-4));
          CHECK(found[k].force == doctest::Approx(wanted.force).epsilon(1e-4));
        }
      }
    }
  }
}

TEST_CASE("errors count where nodes are read, relative to the whole field") {
  ModelData half = model_at(0.02);
  std::size_t read = 0;
  for (LevelData& level : half.levels) {
    for (auto& node : level.nodes) {
      if (node.position[0] < 0) node.flags &= ~std::uint32_t{layout::node_read};
      read += (node.flags & layout::node_read) != 0 ? 1 : 0;
    }
  }
  REQUIRE(read > 10);
  ModelData other = model_at(0.02);
  for (LevelData& level : other.levels) {
    for (auto& node : level.nodes) {
      if (node.position[0] >= 0) node.flags &= ~std::uint32_t{layout::node_read};
    }
  }
  const Model right(half), left(other);
  const std::size_t finest = right.compressed.finest();
  const auto all = coarse_model().answered.all_errors(finest), of_right = right.answered.all_errors(finest),
             of_left = left.answered.all_errors(finest);
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(std::hypot(of_right[i].field, of_left[i].field) == doctest::Approx(all[i].field));
    CHECK(std::max(of_right[i].peak, of_left[i].peak) == all[i].peak);
    CHECK(of_right[i].force == all[i].force);
  }
}

TEST_CASE("total forces of two fingers are told apart, and are better known than the nodal ones") {
  const auto& answered = coarse_model().answered;
  const auto summary = summarise(answered.all_errors(coarse_model().compressed.finest()));
  std::size_t compared = 0;
  for (const auto& errors : summary) {
    CHECK(errors.total_force.has_value() == layout::has_total_force(errors.kind));
    if (!errors.total_force || errors.contacts < 16) continue;
    ++compared;
    CHECK(errors.total_force->worst <= errors.force.worst);
    CHECK(errors.total_force->median < errors.force.median);
  }
  CHECK(compared >= 4);
}

TEST_CASE("a compliance that is not positive definite has infinite errors, stored as the largest float") {
  ModelData broken = model_at(0.001);
  for (LevelData& level : broken.levels) {
    for (auto& scale : level.scales.of<3>()) {
      for (float& element : scale.diagonal) element *= 0.05F;
    }
  }
  const Model model(broken);
  const auto errors = model.answered.all_errors(model.compressed.finest());
  CHECK(worst(errors, &AnswerError::field) == std::numeric_limits<double>::infinity());
  CHECK(worst(errors, &AnswerError::total_force) == std::numeric_limits<double>::infinity());
  ModelData stored = model_at(0.01);
  stored.levels.back().patterns = pattern_records(summarise(errors));
  const test::File file(stored);
  float largest = 0;
  for (const auto& record : file.view.level[file.view.levels - 1].patterns) {
    largest = std::max(largest, record.field_error[2]);
  }
  CHECK(largest == std::numeric_limits<float>::max());
}

TEST_CASE("quantiles: of n samples the smallest that half, 95 % and all do not exceed") {
  std::vector<double> values;
  for (int i = 100; i > 0; --i) values.push_back(i);
  const Quantiles hundred = quantiles(values);
  CHECK(hundred.median == 50);
  CHECK(hundred.p95 == 95);
  CHECK(hundred.worst == 100);
  const Quantiles one = quantiles({3});
  CHECK(one.median == 3);
  CHECK(one.p95 == 3);
  CHECK(one.worst == 3);
  const Quantiles three = quantiles({3, 1, 2});
  CHECK(three.median == 2);
  CHECK(three.p95 == 3);
}

TEST_CASE("a summary is by kind, then contacts, as a file wants it") {
  const auto summary = summarise({{PatternKind::pinch, 4, 0.2, 0.3, 0.1, 0.05},
                                  {PatternKind::patch, 16, 0.1, 0.1, 0.1, 0.1},
                                  {PatternKind::patch, 4, 0.1, 0.1, 0.1, 0.1},
                                  {PatternKind::pinch, 4, 0.4, 0.1, 0.2, 0.01},
                                  {PatternKind::turned, 4, 0.1, 0.1, 0.1, 0}});
  REQUIRE(summary.size() == 4);
  CHECK(summary[0].contacts == 4);
  CHECK(summary[1].contacts == 16);
  CHECK(summary[2].kind == PatternKind::turned);
  CHECK(summary[3].samples == 2);
  CHECK(summary[3].field.median == 0.2);
  CHECK(summary[3].field.worst == 0.4);
  CHECK(summary[3].total_force->worst == 0.05);
  const auto records = pattern_records(summary);
  CHECK(records[3].kind == 6);
  CHECK(records[3].field_peak[2] == 0.3F);
  CHECK(records[2].total_force_error[2] == 0);
}

}  // namespace
}  // namespace greenloop::offline
