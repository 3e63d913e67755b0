#include "rt_tests/bench/field_benchmark.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "rt_tests/bench/contact_sets.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/bench/stepper.hpp"

namespace greenloop::bench {
namespace {

constexpr std::uint64_t seed = 20030101;
constexpr std::size_t columns_in_turn = 512;  ///< dense columns that take turns: more than a second-level cache holds
constexpr std::size_t fewest_sets = 4, most_sets = 64;

double microseconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - since).count();
}

/// Sums of squares of the field's error and answer, and the worst errors of forces.
struct ErrorSum {
  double error = 0, exact = 0, worst_force = 0, worst_total = 0;

  void add(const Solution& truth, const std::vector<int>& row_node, Stepper& answer) {
    for (std::size_t r = 0; r < row_node.size(); ++r) {
      const Eigen::Vector3d u = truth.displacement.segment<3>(3 * static_cast<Eigen::Index>(r));
      const Eigen::Map<const Eigen::Vector3f> found(answer.displacement() + 4 * static_cast<std::size_t>(row_node[r]));
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

/// Everything one contact count is measured with.
struct Bench {
  const std::vector<std::vector<Contact>>& sets;
  const ExactColumns& columns;
  const std::vector<int>& row_node;
  std::vector<Solution> truth;
  std::vector<std::vector<float>> forces;  ///< what the dense sum is given
  Stepper& cached;
};

double dense_round(Bench& bench, Eigen::VectorXf& field) {
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < bench.sets.size(); ++i) {
    bench.columns.sum(bench.sets[i], bench.forces[i].data(), field);
  }
  return microseconds(start) / static_cast<double>(bench.sets.size());
}

double step_round(const std::vector<std::vector<Contact>>& sets, Stepper& stepper, std::uint64_t work = UINT64_MAX) {
  const auto start = std::chrono::steady_clock::now();
  for (const auto& set : sets) {
    stepper.step(set, work);
  }
  return microseconds(start) / static_cast<double>(sets.size());
}

void measure_moving(Bench& bench, std::size_t rounds, FieldFigures& figures) {
  Eigen::VectorXf field(3 * static_cast<Eigen::Index>(bench.row_node.size()));
  std::vector<double> dense, step, ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    dense.push_back(dense_round(bench, field));
    step.push_back(step_round(bench.sets, bench.cached));
    ratio.push_back(dense.back() / step.back());
  }
  figures.dense_us = median(dense);
  figures.step_us = median(step);
  figures.dense_ratio = median(ratio);
}

void measure_same_set(Bench& bench, std::size_t rounds, FieldFigures& figures) {
  Eigen::VectorXf field(3 * static_cast<Eigen::Index>(bench.row_node.size()));
  std::vector<double> ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    const std::size_t i = round % bench.sets.size();
    const std::vector<std::vector<Contact>> same(bench.sets.size(), bench.sets[i]);
    step_round(same, bench.cached);
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < same.size(); ++k) {
      bench.columns.sum(same[k], bench.forces[i].data(), field);
    }
    const double dense = microseconds(start) / static_cast<double>(same.size());
    ratio.push_back(dense / step_round(same, bench.cached));
  }
  figures.same_set_dense_ratio = median(ratio);
}

/// Lowers every set's budget to just below what its last answer took, until nothing coarser is left.
void descend(Bench& bench, std::size_t rounds, FieldFigures& figures) {
  std::vector<std::uint64_t> budget(bench.sets.size(), UINT64_MAX);
  while (true) {
    Rung rung;
    ErrorSum errors;
    std::vector<double> work, time;
    for (std::size_t i = 0; i < bench.sets.size(); ++i) {
      const StepReport report = bench.cached.step(bench.sets[i], budget[i]);
      if (report.status > Status::coarser) {
        return;
      }
      rung.constraint_level = report.constraint_level;
      rung.field_level = report.field_level;
      work.push_back(static_cast<double>(report.work));
      errors.add(bench.truth[i], bench.row_node, bench.cached);
    }
    for (std::size_t round = 0; round < rounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      for (std::size_t i = 0; i < bench.sets.size(); ++i) {
        bench.cached.step(bench.sets[i], budget[i]);
      }
      time.push_back(microseconds(start) / static_cast<double>(bench.sets.size()));
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
  Stepper cached(model, figures.contacts, sets.size() * model.level_count());
  Bench bench{sets, columns, store.contents().row_node, {}, {}, cached};

  ErrorSum errors;
  std::vector<double> work;
  for (const auto& set : sets) {
    if (cached.step(set).status > Status::coarser) {
      throw std::runtime_error("a set of " + std::to_string(set.size()) + " contacts was refused with status " +
                               std::to_string(static_cast<int>(cached.step(set).status)));
    }
    work.push_back(static_cast<double>(cached.step(set).work));
    bench.truth.push_back(columns.solve(set));
    bench.forces.emplace_back(cached.force());
    errors.add(bench.truth.back(), bench.row_node, cached);
  }
  figures.work = static_cast<std::uint64_t>(median(work));
  figures.rms_error = errors.rms();
  figures.force_error = errors.worst_force;
  figures.total_force_error = errors.worst_total;

  measure_moving(bench, rounds, figures);
  measure_same_set(bench, rounds, figures);
  figures.backsolve_ratio = 1e6 * back_substitution_seconds / figures.step_us;

  Stepper fresh(model, figures.contacts, 1);
  std::vector<double> time;
  for (std::size_t round = 0; round < std::max<std::size_t>(1, rounds / 10); ++round) {
    time.push_back(step_round(sets, fresh));
  }
  figures.fresh_step_us = median(time);
  descend(bench, rounds / 4 + 1, figures);
  return figures;
}

}  // namespace greenloop::bench
