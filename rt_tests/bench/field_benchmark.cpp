#include "rt_tests/bench/field_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "rt_tests/bench/contact_sets.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop::bench {
namespace {

constexpr std::uint64_t seed = 20030101;
constexpr std::size_t columns_in_turn = 512;  ///< dense columns that take turns: more than a second-level cache holds
constexpr std::size_t fewest_sets = 4, most_sets = 64;

Elastostatic::Limits limits_of(std::size_t contacts, std::size_t factors) {
  return {.max_contacts = static_cast<std::uint32_t>(contacts), .cached_factors = static_cast<std::uint32_t>(factors)};
}

bool is_read(const ModelView& view, std::uint32_t node) {
  return (node_record(view, node).flags & layout::node_read) != 0;
}

/// Sums of squares of the field's error and answer where it is read, and the worst errors of forces.
struct ErrorSum {
  const ModelView& view;
  double error = 0, exact = 0, worst_force = 0, worst_total = 0;

  void add(const Solution& truth, const std::vector<int>& row_node, const Hosted<Elastostatic>& answer) {
    for (std::size_t r = 0; r < row_node.size(); ++r) {
      if (!is_read(view, static_cast<std::uint32_t>(row_node[r]))) {
        continue;
      }
      const Eigen::Vector3d u = truth.displacement.segment<3>(3 * static_cast<Eigen::Index>(r));
      const Eigen::Map<const Eigen::Vector3f> found(answer.field().data() + 4 * static_cast<std::size_t>(row_node[r]));
      error += (found.cast<double>() - u).squaredNorm();
      exact += u.squaredNorm();
    }
    Eigen::Vector3d total = Eigen::Vector3d::Zero(), total_found = total;
    for (Eigen::Index j = 0; j < truth.force.size() / 3; ++j) {
      total += truth.force.segment<3>(3 * j);
      total_found += Eigen::Map<const Eigen::Vector3f>(answer.force().data() + 3 * j).cast<double>();
    }
    worst_total = std::max(worst_total, (total_found - total).norm() / total.norm());
    const Eigen::Map<const Eigen::VectorXf> found(answer.force().data(), truth.force.size());
    worst_force = std::max(worst_force, (found.cast<double>() - truth.force).norm() / truth.force.norm());
  }

  [[nodiscard]] double rms() const { return std::sqrt(error / exact); }
};

/// Fields of given forces, without the step that finds them.
class FieldSums {
 public:
  FieldSums(const Model& model, const std::vector<std::vector<Constraint>>& sets,
            const std::vector<std::vector<float>>& forces)
      : placed_(model.view(), static_cast<std::uint32_t>(sets.front().size())),
        level_(model.level_count() - 1),
        x_(model.node_count()) {
    Body& body = *placed_.body;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      resolve_contacts(sets[i], model.view(), body.facts, {level_}, body.resolution, body.planned);
      Columns columns{{body.planned.column, body.planned.column + body.planned.columns}, {}};
      columns.force.resize(3 * columns.column.size());
      for (std::size_t k = 0; k < 3 * sets[i].size(); ++k) {
        columns.force[3 * body.planned.place[k / 3] + k % 3] += forces[i][k];
      }
      sets_.push_back(std::move(columns));
    }
  }

  void round() {
    Body& body = *placed_.body;
    for (const Columns& set : sets_) {
      const auto count = static_cast<std::uint32_t>(set.column.size());
      clear(body.touched);
      touch(body.refinement, set.column.data(), count, body.touched);
      compute_field<3>(body.field_model(), {count, set.column.data(), set.force.data()}, body.touched, {level_, level_},
                       body.field_scratch(), x_.data());
    }
  }

 private:
  struct Columns {
    std::vector<std::uint32_t> column;
    std::vector<float> force;
  };
  PlacedBody placed_;
  std::uint32_t level_;
  std::vector<Columns> sets_;
  std::vector<Float4> x_;
};

/// Everything one contact count is measured with.
struct Bench {
  const ModelView* view;
  const std::vector<std::vector<Constraint>>& sets;
  const ExactColumns& columns;
  const std::vector<int>& row_node;
  std::vector<Solution> truth;
  std::vector<std::vector<float>> forces;  ///< what the dense sum is given
  Hosted<Elastostatic>& cached;
};

// microseconds for each of the sets
template <class Round>
double time_of_sets(const Bench& bench, Round round) {
  return time_of(1, round) / static_cast<double>(bench.sets.size());
}

void sum_dense(const Bench& bench, Eigen::VectorXf& field) {
  for (std::size_t i = 0; i < bench.sets.size(); ++i) {
    bench.columns.sum(bench.sets[i], bench.forces[i].data(), field);
  }
}

void step_sets(const std::vector<std::vector<Constraint>>& sets, Hosted<Elastostatic>& body) {
  for (const auto& set : sets) {
    body.step(set);
  }
}

void measure_moving(const Model& model, Bench& bench, std::size_t rounds, FieldFigures& figures) {
  Eigen::VectorXf field(3 * static_cast<Eigen::Index>(bench.row_node.size()));
  FieldSums sums(model, bench.sets, bench.forces);
  const auto step = [&] { step_sets(bench.sets, bench.cached); };
  std::vector<double> dense, cold, warm, given, field_ratio, warm_ratio, cold_ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    dense.push_back(time_of_sets(bench, [&] { sum_dense(bench, field); }));
    cold.push_back(time_of_sets(bench, step));
    warm.push_back(time_of_sets(bench, step));
    sums.round();
    given.push_back(time_of_sets(bench, [&] { sums.round(); }));
    field_ratio.push_back(dense.back() / given.back());
    warm_ratio.push_back(dense.back() / warm.back());
    cold_ratio.push_back(dense.back() / cold.back());
  }
  figures.dense_us = median(dense);
  figures.field_us = median(given);
  figures.step_us = median(warm);
  figures.cold_step_us = median(cold);
  figures.field_dense_ratio = median(field_ratio);
  figures.dense_ratio = median(warm_ratio);
  figures.cold_dense_ratio = median(cold_ratio);
}

void measure_same_set(Bench& bench, std::size_t rounds, FieldFigures& figures) {
  Eigen::VectorXf field(3 * static_cast<Eigen::Index>(bench.row_node.size()));
  std::vector<double> ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    const std::size_t i = round % bench.sets.size();
    const std::vector<std::vector<Constraint>> same(bench.sets.size(), bench.sets[i]);
    step_sets(same, bench.cached);
    const double dense = time_of_sets(bench, [&] {
      for (const auto& set : same) {
        bench.columns.sum(set, bench.forces[i].data(), field);
      }
    });
    ratio.push_back(dense / time_of_sets(bench, [&] { step_sets(same, bench.cached); }));
  }
  figures.same_set_dense_ratio = median(ratio);
}

/// Lowers every set's budget to just below what its last answer took, until nothing coarser is left.
void descend(Bench& bench, std::size_t rounds, FieldFigures& figures) {
  std::vector<std::uint64_t> budget(bench.sets.size(), any_budget);
  while (true) {
    Rung rung;
    ErrorSum errors{*bench.view};
    std::vector<double> work, time;
    for (std::size_t i = 0; i < bench.sets.size(); ++i) {
      const Elastostatic::StepReport report = bench.cached.step(bench.sets[i], budget[i]);
      if (!answered(report.status)) {
        return;
      }
      rung.constraint_level = report.constraint_level;
      rung.field_level = report.field_level;
      work.push_back(static_cast<double>(report.work));
      errors.add(bench.truth[i], bench.row_node, bench.cached);
    }
    for (std::size_t round = 0; round < rounds; ++round) {
      time.push_back(time_of_sets(bench, [&] {
        for (std::size_t i = 0; i < bench.sets.size(); ++i) {
          bench.cached.step(bench.sets[i], budget[i]);
        }
      }));
    }
    rung.work = static_cast<std::uint64_t>(median(work));
    rung.step_us = median(time);
    rung.rms_error = errors.rms();
    rung.force_error = errors.worst_force;
    figures.rungs.push_back(rung);
    for (std::size_t i = 0; i < bench.sets.size(); ++i) {
      budget[i] = static_cast<std::uint64_t>(work[i]) - 1;
    }
  }
}

}  // namespace

FieldFigures measure_field(const Model& model, const GreenStore& store, std::size_t contacts, std::size_t rounds,
                           double back_substitution_seconds) {
  FieldFigures figures;
  const auto sets =
      patch_contacts(model.view(), std::clamp(columns_in_turn / contacts, fewest_sets, most_sets), contacts, seed);
  figures.contacts = sets.front().size();
  figures.sets = sets.size();
  const ExactColumns columns(store, sets);
  // room for every set's factor on every level it may descend to
  Hosted<Elastostatic> cached(model, limits_of(figures.contacts, sets.size() * model.level_count()));
  Bench bench{&model.view(), sets, columns, store.contents().row_node, {}, {}, cached};

  ErrorSum errors{model.view()};
  std::vector<double> work;
  for (const auto& set : sets) {
    if (!answered(cached.step(set).status)) {
      throw std::runtime_error("a set of " + std::to_string(set.size()) + " contacts was refused with status " +
                               std::to_string(static_cast<int>(cached.step(set).status)));
    }
    work.push_back(static_cast<double>(cached.step(set).work));
    bench.truth.push_back(columns.solve(set));
    bench.forces.emplace_back(cached.force().begin(), cached.force().end());
    errors.add(bench.truth.back(), bench.row_node, cached);
  }
  figures.work = static_cast<std::uint64_t>(median(work));
  figures.rms_error = errors.rms();
  figures.force_error = errors.worst_force;
  figures.total_force_error = errors.worst_total;

  measure_moving(model, bench, rounds, figures);
  measure_same_set(bench, rounds, figures);
  figures.backsolve_ratio = 1e6 * back_substitution_seconds / figures.step_us;

  Hosted<Elastostatic> fresh(model, limits_of(figures.contacts, 1));
  std::vector<double> time;
  for (std::size_t round = 0; round < std::max<std::size_t>(1, rounds / 10); ++round) {
    time.push_back(time_of_sets(bench, [&] { step_sets(sets, fresh); }));
  }
  figures.fresh_step_us = median(time);
  descend(bench, rounds / 4 + 1, figures);
  return figures;
}

}  // namespace greenloop::bench
