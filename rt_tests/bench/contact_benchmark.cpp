#include "rt_tests/bench/contact_benchmark.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "rt_tests/bench/contact_sets.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/bench/siconos.hpp"
#include "rt_tests/bench/thread_timer.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/testing/carved.hpp"
#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr float asked_residual = 1e-3F;
constexpr int presses = 10;
constexpr int drags = 20;

Vec4 stored(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

// of the points' own compliance among each other
std::vector<Block<3>> compliance_of(const Model& model, const std::vector<Constraint>& set) {
  const auto count = static_cast<std::uint32_t>(set.size());
  Hosted<Elastostatic> body(model, {.max_contacts = count, .forces_only = true, .keep_capacitance = true});
  body.step(set, any_budget, false);
  std::vector<Block<3>> blocks(ContactCompliance::size(count));
  for (std::uint32_t j = 0; j < count; ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) {
      float block[9];
      if (!body.body().compliance(i, j, block)) throw std::runtime_error("no compliance of the contacts");
      for (std::size_t c = 0; c < 3; ++c) {
        ContactCompliance{blocks.data()}.at(i, j).column[c] =
            Float4{block[3 * c], block[3 * c + 1], block[3 * c + 2], 0};
      }
    }
  }
  return blocks;
}

/// A patch as a plane: across it the smallest extent, into the body.
struct Plane {
  Vector3d middle;
  Vector3d inwards;
};

Plane plane_of(const ModelView& model, const std::vector<Vector3d>& places) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& place : places) middle += place / static_cast<double>(places.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const Vector3d& place : places) spread += (place - middle) * (place - middle).transpose();
  Vector3d axis = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors().col(0);
  Vector3d body = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) body[k] = 0.5 * (double{model.info->box_min[k]} + double{model.info->box_max[k]});
  return {middle, (body - middle).dot(axis) < 0 ? Vector3d(-axis) : axis};
}

struct Timed {
  ContactAnswer answer;
  double us;
};

/// Solves a sequence step by step; what a point slipped is not slipped again.
class Solver {
 public:
  explicit Solver(ContactSequence& sequence)
      : force(sequence.steps.front().size()),
        displacement(force.size()),
        shift_(force.size(), Vec4{}),
        compliance_{sequence.compliance.data()},
        problem_(static_cast<std::uint32_t>(force.size())) {}

  /// The candidates of a step as they are after those before.
  [[nodiscard]] std::vector<ContactCandidate> from_here(std::vector<ContactCandidate> step) const {
    for (std::size_t i = 0; i < step.size(); ++i) {
      const Vec4& n = step[i].normal;
      const float along = shift_[i].x * n.x + shift_[i].y * n.y + shift_[i].z * n.z;
      step[i].gap.x -= shift_[i].x - along * n.x;
      step[i].gap.y -= shift_[i].y - along * n.y;
      step[i].gap.z -= shift_[i].z - along * n.z;
    }
    return step;
  }

  Timed solve(const std::vector<ContactCandidate>& step) {
    const ThreadTimer timer;
    const ContactAnswer answer =
        problem_->solve(step, compliance_, {.residual = asked_residual}, any_budget, force, {}, displacement);
    return {answer, timer.us()};
  }

  void advance(const std::vector<ContactCandidate>& step) {
    for (std::size_t i = 0; i < step.size(); ++i) {
      shift_[i] = {displacement[i].x - step[i].gap.x, displacement[i].y - step[i].gap.y,
                   displacement[i].z - step[i].gap.z, 0};
    }
  }

  std::vector<Vec4> force;
  std::vector<Vec4> displacement;

 private:
  std::vector<Vec4> shift_;
  ContactCompliance compliance_;
  Carved<ContactProblem> problem_;
};

struct Samples {
  std::vector<double> warm, cold, work;
  std::vector<double> siconos[2];  ///< NSGS, nonsmooth Newton: of steps that it solved
  std::size_t siconos_failed[2] = {};
};

struct SolvedStep {
  std::vector<ContactCandidate> candidates;
  std::vector<Vec4> start, forces;
};

void time_siconos(ContactSequence& sequence, const SolvedStep& step, Samples& samples) {
  SiconosProblem other({sequence.compliance.data()}, step.candidates);
  for (const bool newton : {false, true}) {
    const auto answer = other.solve(newton, step.start, step.forces, double{asked_residual});
    if (answer.solved) {
      samples.siconos[newton ? 1 : 0].push_back(answer.us);
    } else {
      ++samples.siconos_failed[newton ? 1 : 0];
    }
  }
}

// one solver after the other, so that neither finds the other's data in the caches instead of its own
void time_sequence(ContactSequence& sequence, Samples& samples, ContactFigures& figures) {
  std::vector<SolvedStep> solved;
  Solver solver(sequence);
  Solver cold(sequence);
  for (const auto& next : sequence.steps) {
    const std::vector<ContactCandidate> step = solver.from_here(next);
    const std::vector<Vec4> start = solver.force;
    const Timed timed = solver.solve(step);
    solver.advance(step);
    samples.warm.push_back(timed.us);
    samples.work.push_back(static_cast<double>(timed.answer.work));
    figures.residual = std::max(figures.residual, timed.answer.residual);
    figures.unfinished += timed.answer.residual > asked_residual ? 1 : 0;
    std::fill(cold.force.begin(), cold.force.end(), Vec4{});
    samples.cold.push_back(cold.solve(step).us);
    solved.push_back({step, start, solver.force});
  }
  if (!SiconosProblem::available()) return;
  for (const SolvedStep& step : solved) time_siconos(sequence, step, samples);
}

}  // namespace

ContactSequence pressed_and_dragged(const Model& model, std::size_t contacts, float friction, std::uint64_t seed) {
  const std::vector<Constraint> set = patch_contacts(model.view(), 1, contacts, seed).front();
  std::map<std::uint32_t, Vector3d> place_of;
  visit_touchable(model.view(), [&](std::uint32_t node, const layout::NodeRecord& record) {
    place_of[node] = Vector3d(record.position[0], record.position[1], record.position[2]);
  });
  std::vector<Vector3d> places;
  places.reserve(set.size());
  for (const Constraint& constraint : set) places.push_back(place_of.at(constraint.node));
  const Plane plane = plane_of(model.view(), places);
  ContactSequence sequence{compliance_of(model, set), {}};
  double radius = 0;
  for (const Vector3d& place : places) radius = std::max(radius, (place - plane.middle).norm());
  const Vector3d along = plane.inwards.unitOrthogonal();
  for (int k = 1; k <= presses + drags; ++k) {
    const double depth = 0.06 * radius * std::min(1.0, k / double{presses});
    const Vector3d way = (k > presses ? 0.004 * radius : 0) * along;
    std::vector<ContactCandidate> step;
    for (const Vector3d& place : places) {
      const double r = (place - plane.middle).cross(plane.inwards).norm();
      const double gap = r * r / (20 * radius) - depth;
      step.push_back({stored(gap * plane.inwards - way), stored(plane.inwards), friction});
    }
    sequence.steps.push_back(std::move(step));
  }
  return sequence;
}

ContactFigures measure_contacts(const Model& model, std::size_t contacts, float friction, std::size_t patches) {
  ContactFigures figures;
  figures.friction = friction;
  Samples samples;
  for (std::size_t k = 0; k < patches; ++k) {
    ContactSequence sequence = pressed_and_dragged(model, contacts, friction, 20030102 + k);
    figures.contacts = sequence.steps.front().size();
    time_sequence(sequence, samples, figures);
  }
  figures.us = median(samples.warm);
  figures.worst_us = *std::max_element(samples.warm.begin(), samples.warm.end());
  figures.cold_us = median(samples.cold);
  figures.work = static_cast<std::uint64_t>(median(samples.work));
  if (SiconosProblem::available()) {
    // an unsolved step counts as one that takes longer than all that were
    SiconosFigures other{.us = 1e30, .solver = "", .failed = samples.warm.size()};
    for (const std::size_t newton : {0, 1}) {
      auto& times = samples.siconos[newton];
      times.resize(samples.warm.size(), 1e30);
      const double here = median(times);
      if (here < other.us) other = {here, newton == 1 ? "NSN_AC" : "NSGS", samples.siconos_failed[newton]};
    }
    figures.siconos = other;
  }
  return figures;
}

}  // namespace greenloop::bench
